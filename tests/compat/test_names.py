"""Every name of kinetix-env is found, or a sentence says what to use."""

import importlib
import subprocess
import sys
import warnings

import pytest

from kinetix.compat import names
from kinetix.compat.names import MODULES

IMPORT_LINES = """
from kinetix.environment import make_kinetix_env
from kinetix.environment.env import make_kinetix_env
from kinetix.environment.env import make_kinetix_env_from_name
from kinetix.environment.env import KinetixEnv
from kinetix.environment.env_state import EnvParams, StaticEnvParams
from kinetix.environment.env_state import EnvState
from kinetix.environment.utils import ActionType, ObservationType
from kinetix.environment.spaces import ActionType, ObservationType
from kinetix.environment import EnvParams, StaticEnvParams, EnvState
from kinetix.environment import ActionType, ObservationType
from kinetix.environment import LogWrapper
from kinetix.environment.wrappers import LogWrapper
from kinetix.environment.wrappers import AutoReplayWrapper, UnderspecifiedEnvWrapper, GymnaxWrapper
from kinetix.environment.ued.ued import make_reset_fn_sample_kinetix_level
from kinetix.environment.ued.ued import make_reset_fn_from_config
from kinetix.environment import make_reset_fn_from_config
from kinetix.environment.ued.distributions import sample_kinetix_level
from kinetix.environment.ued.ued_state import UEDParams
from kinetix.util import load_from_json_file
from kinetix.util.saving import load_from_json_file
from kinetix.util.saving import load_evaluation_levels
from kinetix.util.config import normalise_config, generate_params_from_config
from kinetix.util import general_eval
from kinetix.render import make_render_pixels
from kinetix.render.renderer_pixels import make_render_pixels
from kinetix.render.renderer_symbolic_entity import EntityObservation
from kinetix.models import make_network_from_config, ScannedRNN
from kinetix.models.actor_critic import MultiHeadDense
from kinetix.data import TrajectoryDatasetManager
""".strip().splitlines()

EVERY_NAME = [(module, name) for module, found in MODULES.items() for name in found]


@pytest.mark.parametrize("line", IMPORT_LINES)
@pytest.mark.filterwarnings("ignore:.*before 2.0:FutureWarning")
def test_the_import_lines_of_other_projects_work(line):
    exec(line, {})


@pytest.mark.parametrize(("module", "name"), EVERY_NAME, ids=lambda value: value)
@pytest.mark.filterwarnings("ignore:.*before 2.0:FutureWarning")
def test_every_name_is_there_or_says_what_to_use(module, name):
    place = MODULES[module][name]
    if place.home:
        assert getattr(importlib.import_module(module), name) is not None
    else:
        with pytest.raises(ImportError, match=r"does not exist here: \w+"):
            getattr(importlib.import_module(module), name)


def test_submodules_of_made_modules_are_imported_by_any_way():
    import kinetix.environment.ued.ued as ued
    import kinetix.util.saving as saving

    assert ued.make_reset_fn_from_config and saving.load_from_json_file
    assert "load_from_json_file" in dir(saving)


@pytest.mark.parametrize("module", MODULES)
def test_every_module_is_an_attribute_of_its_package(module, monkeypatch):
    package, _, name = module.rpartition(".")
    found = importlib.import_module(module)
    monkeypatch.delattr(importlib.import_module(package), name)
    assert getattr(importlib.import_module(package), name) is found


def test_an_old_name_warns_once(monkeypatch):
    monkeypatch.setattr(names, "_warned", set())
    import kinetix.environment.env as env

    with pytest.warns(FutureWarning, match=r"before 2\.0: use make_kinetix_env"):
        env.make_kinetix_env_from_name  # noqa: B018
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env.make_kinetix_env_from_name  # noqa: B018


def test_a_name_that_nobody_has_is_an_ordinary_error():
    with pytest.raises(ImportError, match="cannot import name 'make_renderer'"):
        exec("from kinetix.render.renderer_pixels import make_renderer", {})
    with pytest.raises(ModuleNotFoundError, match=r"kinetix\.utility"):
        exec("import kinetix.utility", {})
    import kinetix

    with pytest.raises(AttributeError, match="did you mean 'make_kinetix_env'"):
        kinetix.make_kinetic_env  # noqa: B018


def test_the_modules_load_no_jax():
    code = (
        "import sys, kinetix, kinetix.util.saving, kinetix.environment.ued.ued, kinetix.models; "
        "dir(kinetix); kinetix.__version__; "
        "sys.exit(', '.join({'jax', 'numpy', 'pygame'} & set(sys.modules)) or 0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
