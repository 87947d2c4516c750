"""The JSON Schema of scenes, for editors that complete and check TOML files.

The schema comes from the models of :mod:`fingerpad.scene`: keys, types, ranges, units, defaults and meanings. A number
with a unit may also be a text such as ``"10 um"``. What concerns several keys at once, and whether a unit fits, is
checked by the program alone.
"""

from dataclasses import MISSING, Field
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from fingerpad.scene.keys import docstrings, tables
from fingerpad.scene.law_keys import LawKey, keys_of, range_of
from fingerpad.scene.scene import Scene
from geometry.units import QUANTITIES, Range

DIALECT = "https://json-schema.org/draft/2020-12/schema"
_NUMBER = r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?"
_NUMBER_AND_UNIT = _NUMBER + r"\s*[^\s0-9.+-].*$"
_NAME = {"description": "Name of the law."}
_SWEEP = {
    "type": "object",
    "description": "Of a study, for fingerpad sweep: a list or a range such as 0:200:5 by key.",
    "additionalProperties": {
        "anyOf": [{"type": "array", "minItems": 1}, {"type": "string"}, {"type": "object"}],
    },
}


class _Generator(GenerateJsonSchema):
    """Writes ranges and texts with a unit, where pydantic sees a function; TOML has no null."""

    def function_wrap_schema(self, schema: core_schema.WrapValidatorFunctionSchema) -> JsonSchemaValue:
        """Return the schema of a number within a range."""
        function = schema["function"]["function"]
        return _number(function) if isinstance(function, Range) else super().function_wrap_schema(schema)

    def function_plain_schema(self, schema: core_schema.PlainValidatorFunctionSchema) -> JsonSchemaValue:
        """Return the schema of a law."""
        key = getattr(schema["function"]["function"], "__self__", None)
        return _law(key) if isinstance(key, LawKey) else super().function_plain_schema(schema)

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        """Return the schema of the value; a key that may be missing is left out."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        """Return the schema with its default, unless this is a whole table or nothing."""
        found = super().default_schema(schema)
        if found.get("default") is None or isinstance(found["default"], dict):
            found.pop("default", None)
        return found


def schema() -> dict[str, Any]:
    """Return the JSON Schema of a scene file, ready for JSON."""
    found = Scene.model_json_schema(schema_generator=_Generator, mode="validation")
    parts = found["$defs"] | {Scene.__name__: found}
    for model in dict.fromkeys(tables(Scene)):
        _describe(parts[model.__name__], model)
        for name, field in model.model_fields.items():
            if flat := next((key.flat for key in field.metadata if isinstance(key, LawKey)), ""):
                _flatten(parts[model.__name__], name, flat)
    found["properties"]["sweep"] = _SWEEP
    return {"$schema": DIALECT, "title": "Scene of fingerpad"} | found


def _describe(part: JsonSchemaValue, model: type[BaseModel]) -> JsonSchemaValue:
    """Return the schema of a table, with the docstrings of the model and its keys put into it."""
    part["description"] = " ".join((model.__doc__ or "").split("\n\n")[0].split())
    part.pop("title", None)
    for name, value in part["properties"].items():
        value.pop("title", None)
        if words := docstrings(model).get(name):
            value["description"] = words
    return part


def _law(key: LawKey) -> JsonSchemaValue:
    """Return the schema of a law: a table of one of the package or of one's own, or the number that a key takes."""
    limits = range_of(keys_of(key.default)[key.number]) if key.number else None
    found = [] if limits is None else [_number(limits)]
    for name, law in key.kind.laws.items():
        default = law is type(key.default)
        own = {each.name: _parameter(law, each) for each in keys_of(law).values()}
        for table in key.tables if default else ():
            own[table.__name__.lower()] = _describe(table.model_json_schema(schema_generator=_Generator), table)
        left = [each.name for each in keys_of(law).values() if each.default is MISSING]
        found.append(
            {
                "type": "object",
                "properties": {"law": {"const": name, "description": "Name of the law."}} | own,
                "additionalProperties": False,
            }
            | ({} if default else {"required": ["law", *left]})
        )
    own_law = {"type": "string", "pattern": r"^[\w.]+:[\w.]+$", "description": "module:Class on Python's path"}
    return {"anyOf": [*found, {"type": "object", "properties": {"law": own_law}, "required": ["law"]}]}


def _flatten(part: JsonSchemaValue, law: str, name: str) -> None:
    """Put the keys of a law into the table around it.

    Args:
        part: schema of that table.
        law: key that holds the law.
        name: key of the law's name.
    """
    properties = part.pop("properties")
    part["anyOf"] = properties.pop(law)["anyOf"]
    for table in part["anyOf"]:
        table["properties"] = {name: table["properties"].pop("law")} | table["properties"] | properties
        if "required" in table:
            table["required"] = [name, *table["required"][1:]]
    part.pop("additionalProperties", None)


def _parameter(law: type, field: "Field[Any]") -> JsonSchemaValue:
    limits = range_of(field)
    words = docstrings(law).get(field.name)
    return ({} if limits is None else _number(limits)) | ({"description": words} if words else {})


def _number(bounds: Range) -> JsonSchemaValue:
    """Return the schema of a number within its range, or of a text with a unit where the quantity has one."""
    ranges: list[JsonSchemaValue] = [{"minimum": bounds.low, "maximum": bounds.high}]
    if bounds.sides == 2:
        ranges.append({"minimum": -bounds.high, "maximum": -bounds.low})
    if bounds.zero:
        ranges.append({"const": 0})
    number = {"type": "number"} | (ranges[0] if len(ranges) == 1 else {"anyOf": ranges})
    if not bounds.unit:
        return number
    words = f"a number with a unit of {QUANTITIES[bounds.unit]}"
    text = {"type": "string", "pattern": _NUMBER_AND_UNIT, "description": words}
    return {"anyOf": [number, text]}
