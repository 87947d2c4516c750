"""A history of loads that cannot be run is refused in one short sentence."""

import pytest

from fingerpad.scene import Scene
from tests.test_refusals import SCENES, refusal


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("history = []", "history is empty; it must have at least one entry"),
        ("history = 3", "history is 3; it must be a list"),
        ("[[history]]\nf_ext = 3", "history[0].name is missing; it must be given"),
        ('[[history]]\nname = "a"\nf_ext = -1', "history[0].f_ext is -1 N/m; it must be 0 or from 0.001 to 5000 N/m"),
        (
            '[[history]]\nname = "a"\nf_ext = 0',
            "history[0].name is 'a', which ends at f_ext 0 and voltage 0, where nothing holds the skin on the screen; "
            "one of the two must be greater than 0, or a bone_height be given",
        ),
        (
            '[[history]]\nname = "a"\nf_ext = 1\nuntil_full_slip = 1',
            "history[0].until_full_slip is 1; it must be true or false",
        ),
        (
            '[[history]]\nname = "a"\nf_ext = 1\nbone_height = -1e-3',
            "history[0].f_ext is 1 and history[0].bone_height is -0.001; at most one of the two can be prescribed",
        ),
        (
            '[[history]]\nname = "a"\nf_ext = 1\n[[history]]\nname = "b"\nuntil_full_slip = true',
            "history[1].name is 'b' and nothing else is given; it must come with at least one of "
            "history[1].f_ext, history[1].bone_height, history[1].voltage, history[1].bone_x and history[1].bone_x_by",
        ),
        (
            '[[history]]\nname = "a"\nf_ext = 1\n[[history]]\nname = "b"\nvoltage = 80\nbone_x = 1e-3\n'
            "until_full_slip = true",
            "history[1].voltage is 80 and history[1].until_full_slip is true, which may stop before that is reached; "
            "history[1].voltage must come in a load of its own",
        ),
        (
            '[[history]]\nname = "a/b"\nf_ext = 1',
            "history[0].name is 'a/b'; it must be without '/', since files are named by it",
        ),
        (
            '[[history]]\nname = ".a"\nf_ext = 1',
            "history[0].name is '.a'; it must not begin with '.', since files are named by it",
        ),
        *(
            (
                f'[[history]]\nname = "{first}1+1"\nf_ext = 1',
                f"history[0].name is '{first}1+1'; it must not begin with '{first}', which makes a formula of it when "
                "a table is opened",
            )
            for first in "=+@\uff1d"
        ),
        ('[[history]]\nname = " "\nf_ext = 1', "history[0].name is ' '; it must have a letter or a digit"),
        (
            f'[[history]]\nname = "{"n" * 300}"\nf_ext = 1',
            f"history[0].name is '{'n' * 55}...'; it must be of 100 bytes at most, since files are named by it",
        ),
        (
            '[[history]]\nname = "voltage"\nf_ext = 1\n[[history]]\nname = "voltage"\nf_ext = 2',
            "history[1].name is 'voltage' and history[0].name is 'voltage'; each load must have a name of its own, "
            "also where spaces become _ and letters have no case, since files are named by it",
        ),
        (
            '[[history]]\nname = "a"\nvoltage = 200',
            "history[0].name is 'a', with neither f_ext nor bone_height; the first load must give one of them",
        ),
    ],
)
def test_impossible_history(write, text, message):
    assert refusal(write(text)) == message


@pytest.mark.parametrize(("key", "value"), [("f_ext", 50.0), ("voltage", 0.0), ("slide_length", 1e-3)])
def test_history_and_a_default_load_s_value(key, value):
    """Also where the value given is the default: it would be silently ignored."""
    for given in (value, getattr(Scene(), key)):
        assert refusal(SCENES / "voltage_while_sliding.toml", **{key: given}) == (
            f"{key} is {given:g} and history is given too; with a history each load states its own values"
        )
