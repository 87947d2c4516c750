"""Keys of a scene that hold a law: a material, a law of friction, a model of roughness.

A law is a frozen dataclass. A key takes it as an object, or as a table: its parameters, and in ``law`` the name of a
law of the package or the import path of one's own::

    friction = {law = "Derjaguin", mu_f = 0.3, tau_0 = "5 kPa"}
    friction = {law = "mylaws:Mine", k = 2}

Without ``law`` the parameters are those of the key's default law, and those left out are the default's. Units and
ranges are the metadata of the dataclass (:func:`variational.coefficients.parameter`). Modules are those of
installed packages and of folders that the user names (:mod:`fingerpad.scene.law_code`), so that no file beside a scene
runs code. What is written of a law of one's own has a hash of the file it stands in.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from numbers import Real
from typing import Any, NoReturn

import numpy as np
from pydantic import BaseModel, ValidationError, ValidationInfo
from pydantic_core import CoreSchema, PydanticCustomError, PydanticKnownError, core_schema

from fingerpad.scene.law_code import digest, imported
from fingerpad.scene.messages import LAW, SceneError, clip, show
from geometry.units import Range
from variational.coefficients import said

IMPORT_PATH = re.compile(r"([A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*):([A-Za-z_<>][\w<>]*(?:\.[A-Za-z_<>][\w<>]*)*)", re.ASCII)
_KEPT = ContextVar("kept", default=False)


@contextmanager
def kept() -> Iterator[None]:
    """Import no laws of one's own inside the block, in which results are read: they are :class:`UnresolvedLaw`."""
    before = _KEPT.set(True)
    try:
        yield
    finally:
        _KEPT.reset(before)


def reading_results() -> bool:
    """Return whether :func:`kept` is on."""
    return _KEPT.get()


@dataclass(frozen=True)
class UnresolvedLaw:
    """A law of one's own in results that were read, as it was written: its code is not imported."""

    table: Mapping[str, Any]

    def refuse(self, key: str) -> NoReturn:
        """Refuse to compute with the law.

        Raises:
            SceneError: always.
        """
        raise SceneError(
            f"{key} is of the law {show(self.table.get('law'))}, which is not imported where results are read"
        )


@dataclass(frozen=True)
class Kind:
    """A kind of law."""

    base: type
    """Class that its laws are derived from."""
    words: str
    """What a key holds, to follow "it must be"."""
    laws: Mapping[str, type]
    """The laws of the package, by name."""
    check: Callable[[Any], None] = lambda law: None
    """Refuses an object of one's own by ``ValueError``, in one sentence."""

    def name(self, law: type) -> str:
        """Return the name of a law, or its import path."""
        return next((name for name, each in self.laws.items() if each is law), f"{law.__module__}:{law.__qualname__}")

    def find(self, name: Any) -> type:
        """Return the law of a name or import path, or of a class.

        Raises:
            ValueError: there is no such law; to follow name and semicolon.
        """
        found = name if isinstance(name, type) else self.laws.get(name) if isinstance(name, str) else None
        if found is None and isinstance(name, str) and (parts := IMPORT_PATH.fullmatch(name)):
            found = imported(*parts.groups())
        if found is None:
            raise ValueError(f"it must be {', '.join(map(show, self.laws))} or a law of your own, as 'module:Class'")
        if not (isinstance(found, type) and issubclass(found, self.base)):
            raise ValueError(f"it must be {self.words}")
        if not is_dataclass(found) or not found.__dataclass_params__.frozen:  # type: ignore[attr-defined]
            raise ValueError("a law must be a @dataclass(frozen=True)")
        return found


@dataclass(frozen=True, eq=False)
class LawKey:
    """How a scene's key holds a law, for pydantic: validation and what is written."""

    kind: Kind
    default: Any
    """Law whose parameters complete a table without ``law``."""
    number: str = ""
    """Parameter of the default law that a number in place of a table gives; empty for none."""
    flat: str = ""
    """Key of the law's name where name and parameters stand in the table around the law; else empty."""
    of_scene: Callable[[Mapping[str, Any]], dict[str, Any]] = lambda data: {}
    """Gives values of fields that the scene sets by itself, from the keys before this one."""
    all_laws: bool = False
    """Whether the reference has the parameters of every law, as also with a number or the table around."""

    def tables(self, law: type) -> tuple[type[BaseModel], ...]:
        """Return the tables inside that of a law, which stand there by their names in small letters."""
        return ()

    # -- reading -----------------------------------------------------------------------------------------
    def read(self, value: Any, info: ValidationInfo) -> Any:
        """Return the law of a value: an object, a table, or a number where the key takes one.

        Raises:
            PydanticCustomError: it is none; with the place inside the value.
        """
        given = {name: x for name, x in self.of_scene(info.data).items() if x is not None}
        value = value.table if isinstance(value, UnresolvedLaw) else value
        if is_dataclass(value) or isinstance(value, self.kind.base):
            law, given_table = self._kind_of(type(value)), parameters(value) if is_dataclass(value) else {}
            if value is not self.default:
                self._refuse_other(value, given)
        elif isinstance(value, Mapping):
            given_table = dict(value)
            name = given_table.pop("law", None)
            if _KEPT.get() and isinstance(name, str) and name not in self.kind.laws:
                return UnresolvedLaw(value)
            law = self._kind_of(type(self.default) if name is None else name)
            self._refuse_hash(law, given_table)
            given_table = self.completed(given_table, law)
        elif self.number and isinstance(value, str | Real):
            return _number(keys_of(self.default)[self.number], value, ())
        elif self.number:
            raise key_error(f"is {show(value)}; it must be a number, a table or a {self.kind.base.__name__}")
        else:
            raise PydanticKnownError("model_type", {"class_name": "table"})
        found = self._made(law, given_table, given)
        return getattr(found, self.number) if self.number and type(found) is type(self.default) else found

    def completed(self, table: dict[str, Any], law: type) -> dict[str, Any]:
        """Return a table of parameters with those of the default law."""
        return ({} if law is not type(self.default) else parameters(self.default)) | table

    def check(self, law: Any) -> None:
        """Refuse a law whose parameters are each within their ranges.

        Raises:
            ValueError: in one sentence.
        """
        if law != self.default and not _KEPT.get():  # which both have been computed with
            self.kind.check(law)

    def _kind_of(self, law: Any) -> type:
        try:
            return self.kind.find(law)
        except ValueError as error:
            shown = self.kind.name(law) if isinstance(law, type) else law
            raise key_error(f"is {show(shown)}; {error}", "law") from None

    def _refuse_hash(self, law: type, table: dict[str, Any]) -> None:
        """Refuse a law whose file is not the one that was written."""
        given = table.pop("sha256", None)
        if given is not None and given != digest(law):
            name = self.kind.name(law)
            raise key_error(
                f"is {show(name)}, whose file was changed since; put that one back, or leave out sha256", "law"
            )

    def _refuse_other(self, law: Any, given: Mapping[str, Any]) -> None:
        for name in _of_scene(law) & given.keys():
            own, value = getattr(law, name), given[name]
            same = abs(own - value) <= 1e-6 * abs(value) if isinstance(value, float) else own == value
            if not same:
                raise key_error(f"is {show(own)} and the scene has {show(value)}; the two must be the same", name)

    def _made(self, law: type, table: Mapping[str, Any], given: Mapping[str, Any]) -> Any:
        """Return the law of these parameters, checked."""
        keys, values = keys_of(law), dict[str, Any]()
        for name in table:
            if name not in keys:
                context = {"at": (str(name),), "keys": tuple(keys), "of": self.kind.name(law)}
                raise PydanticCustomError("extra_forbidden", "no such parameter", context)
        for name, field in keys.items():
            if name in table:
                values[name] = _number(field, table[name], (name,))
            elif field.default is MISSING and field.default_factory is MISSING:
                raise key_error("is missing; it must be given", name)
        try:
            found = law(**values, **{name: given[name] for name in _of_scene(law) & given.keys()})
            self.check(found)
        except Exception as error:  # whatever the user's class raises
            own = isinstance(error, ValueError) or self.kind.name(law) in self.kind.laws
            raise law_error(str(error) if own else f"{law.__name__} cannot be made: {said(error)}", *keys) from None
        digest(law)  # reads the file now, which may be edited while a run is on
        return found

    # -- writing -----------------------------------------------------------------------------------------
    def written(self, law: Any) -> Any:
        """Return a law as it stands in a file: a number, or a table that gives the same law again."""
        if isinstance(law, UnresolvedLaw):
            return dict(law.table)
        if not is_dataclass(law):
            return law
        name = self.kind.name(type(law))
        if type(law) is type(self.default):
            return parameters(law)
        return {"law": name} | parameters(law) | ({} if name in self.kind.laws else {"sha256": digest(type(law))})  # type: ignore[arg-type]

    # -- pydantic ----------------------------------------------------------------------------------------
    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Return how pydantic validates and writes the key."""
        write = core_schema.plain_serializer_function_ser_schema(self.written)
        return core_schema.with_info_plain_validator_function(self.read, serialization=write)


def keys_of(law: Any) -> dict[str, "Field[Any]"]:
    """Return the fields of a law or its class that a scene gives, by name."""
    return {f.name: f for f in fields(law) if f.init and "of scene" not in f.metadata}


def _of_scene(law: Any) -> set[str]:
    return {f.name for f in fields(law) if "of scene" in f.metadata}


def parameters(law: Any) -> dict[str, Any]:
    """Return the parameters of a law by name."""
    return {name: _plain(getattr(law, name)) for name in keys_of(law)}


def table(law: Any) -> Any:
    """Return a law as a table with its class, without what the scene sets; any other value as it is.

    A law of :attr:`made_of`, another law and keys beside that one's, has these in one table.
    """
    if isinstance(law, UnresolvedLaw):
        return dict(law.table)
    if hasattr(law, "made_of"):
        inner, more = law.made_of
        return table(inner) | more
    return {"law": type(law)} | parameters(law) if is_dataclass(law) else law


def range_of(field: "Field[Any]") -> Range | None:
    """Return the range of a law's parameter; None where it has none."""
    return Range(*field.metadata["range"]) if "range" in field.metadata else None


def key_error(text: str, *at: str | int) -> PydanticCustomError:
    """Return an error about a place inside a key's value; the text follows that place."""
    return PydanticCustomError(LAW, "{text}", {"text": text, "at": at})


def law_error(text: str, *keys: str) -> PydanticCustomError:
    """Return an error about a key's whole value: a sentence, which may begin with one of the value's keys."""
    return PydanticCustomError(LAW, "{text}", {"text": text, "keys": keys})


def nested_error(error: ValidationError, table: type[BaseModel], *where: str) -> PydanticCustomError:
    """Return the first error of a table inside a key's value, whose place is where."""
    first = error.errors(include_url=False)[0]
    keys = {"keys": tuple(table.model_fields)} if first["type"] == "extra_forbidden" else {}
    at = {"at": (*where, *first["loc"]), "value": first["input"], "said": first["msg"]}
    context = first.get("ctx", {}) | keys | at
    return PydanticCustomError(first["type"], "{said}", context)  # type: ignore[arg-type]


def _number(field: "Field[Any]", value: Any, at: tuple[str, ...]) -> Any:
    """Return a parameter of a law, checked.

    Args:
        field: of the dataclass.
        value: as it was given.
        at: place inside the key's value.
    """
    limits = range_of(field)
    try:
        if limits is not None:
            return limits(value, _strict)  # type: ignore[arg-type]
        if field.type in (float, "float"):
            return _strict(float(value) if type(value) is int and abs(value) < 10**300 else value)
        for kind, name in ((bool, "bool_type"), (int, "int_type"), (str, "string_type")):
            if field.type in (kind, kind.__name__) and type(value) is not kind:
                raise PydanticKnownError(name)  # type: ignore[arg-type]
    except (PydanticCustomError, PydanticKnownError) as error:
        context = dict(error.context or {}) | {"at": at, "value": value, "said": error.message()}
        raise PydanticCustomError(error.type, "{said}", context) from None  # type: ignore[arg-type]
    allowed = field.metadata.get("allowed")
    if allowed is not None and value not in allowed:
        *first, last = map(show, allowed)
        raise key_error(f"is {show(value)}; it must be {', '.join(first)} or {last}", *at)
    found = _plain(value)
    if not _is_data(found):
        raise key_error(f"is {clip(repr(value))}; parameters of a law are numbers, texts, and lists of these", *at)
    return found


def _strict(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise PydanticKnownError("float_type")
    if not np.isfinite(value):
        raise PydanticKnownError("finite_number")
    return float(value)


def _plain(value: Any) -> Any:
    """Return a value of NumPy as Python's, and lists as tuples, so that a law from a file is that from Python."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    return tuple(map(_plain, value)) if isinstance(value, list | tuple) else value


def _is_data(value: Any) -> bool:
    if isinstance(value, tuple):
        return all(map(_is_data, value))
    return value is None or isinstance(value, bool | str) or (isinstance(value, int | float) and np.isfinite(value))
