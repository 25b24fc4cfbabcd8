import json
from pathlib import Path

import pytest

import gaitlab as package
from gaitlab.cli.app import app
from gaitlab.cli.serve import SERVER_COMMANDS

README = Path(__file__).parents[2] / "README.md"
COMMANDS = (
    "analyse", "backup", "compare", "demo", "demo-clinic", "demo-data", "doctor", "export", "export-patient",
    "inspect", "key", "openapi", "predict", "restore", "retention", "schema", "serve", "view", "worker",
)  # fmt: skip


def test_version(gaitlab):
    assert gaitlab("--version")[:2] == (0, package.__version__ + "\n")


def test_without_a_command_the_commands_are_listed(gaitlab):
    code, out, _ = gaitlab()
    assert code == 0
    assert all(command in out for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(gaitlab, command):
    code, out, _ = gaitlab(command, "--help")
    assert code == 0
    assert "Usage" in out


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_in_the_readme(command):
    assert f"`gaitlab {command}`" in README.read_text()


def test_no_command_is_forgotten_here():
    names = {info.name or info.callback.__name__.replace("_", "-") for info in app.registered_commands}
    assert names == set(COMMANDS)


def test_the_commands_of_the_server_are_known_before_they_are_loaded():
    assert {command.__name__.replace("_", "-") for command in SERVER_COMMANDS} == set(package.cli.SERVER)


def test_schema_is_json_and_names_the_parts_of_the_contract(gaitlab):
    code, out, _ = gaitlab("schema")
    document = json.loads(out)["$defs"]["Document"]["properties"]
    assert code == 0
    assert {"version", "inputs", "subject", "events", "spatiotemporal", "kinematics", "weights", "warnings"} <= set(
        document
    )


def test_unknown_commands_are_refused_in_one_line(gaitlab):
    code, _, err = gaitlab("analyze")
    assert code == 2
    assert len(err.strip().splitlines()) == 1
