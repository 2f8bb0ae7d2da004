"""Every shipped config composes, and every option is in step with its component."""

import inspect
from importlib.resources import files

import pytest
from hydra import compose, initialize_config_module
from omegaconf import OmegaConf

from placecue.commands.names import COMMANDS
from placecue.components.build import plain
from placecue.components.hooks import KINDS
from placecue.components.manager import load_plugins
from placecue.components.options import OPTION_KINDS, option_files, register_with_hydra

REGISTRY = load_plugins(built_ins_only=True).registry
OPTIONS = [option for option in option_files("pkg://placecue_conf") if "/" in option]
COMPONENT_OPTIONS = [option for option in OPTIONS if option.split("/")[0] in KINDS]


def option_config(option: str) -> dict:
    """Compose one option of a group, alone."""
    group, name = option.removesuffix(".yaml").split("/")
    register_with_hydra()
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = compose(overrides=[f"+{group}={name}", "+log=a.mcap"])
    part = OmegaConf.select(config, f"cues.{name}" if group == "cue" else group)
    return plain(part) if part is not None else {}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_a_config_that_composes(command: str) -> None:
    register_with_hydra()
    overrides = {"convert": ["source=carmen", "out=x"], "info": ["log=x"]}
    with initialize_config_module(version_base="1.3", config_module="placecue_conf"):
        config = compose(command, overrides.get(command, []))
    assert config is not None
    assert (files("placecue_conf") / f"{command}.yaml").is_file()


@pytest.mark.parametrize("option", COMPONENT_OPTIONS)
def test_every_option_shows_every_parameter(option: str) -> None:
    config = option_config(option)
    kind = option.split("/")[0]
    if not config:
        assert option == "integrator/none.yaml"
        return
    shown = set(config) - {"plugin"} - ({"classifier"} if kind == "cue" else set())
    factory = REGISTRY.load(kind, config["plugin"])  # type: ignore[arg-type]
    assert shown == set(inspect.signature(factory).parameters)


def test_every_component_has_an_option_file() -> None:
    for each in REGISTRY:
        if each.component.kind not in OPTION_KINDS:
            continue
        assert f"{each.component.kind}/{each.component.name}.yaml" in OPTIONS


@pytest.mark.parametrize("option", COMPONENT_OPTIONS)
def test_every_option_begins_with_what_it_is(option: str) -> None:
    text = (files("placecue_conf") / option).read_text()
    lines = [line for line in text.splitlines() if "@package" not in line]
    assert lines[0].startswith("# "), f"{option} does not begin with a comment"
