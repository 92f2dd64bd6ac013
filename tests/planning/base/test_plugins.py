"""Errors of plug-ins: those that went through the code of one name it, all others stay as they are."""

from importlib.metadata import EntryPoint

import pytest

from planning.base import plugins
from planning.base.errors import InputError, PluginError
from planning.base.plugins import Plugin, PluginGroup, guarded, guarded_question, plugin_problems, with_plugin_named


@pytest.fixture
def plugin(monkeypatch):
    """A plug-in whose code is this module; notes about it are forgotten."""
    entry_point = EntryPoint("own", f"{__name__.partition('.')[0]}:here", PluginGroup.AIRCRAFT)
    own = Plugin(PluginGroup.AIRCRAFT, "own", "a-package 1.0", entry_point)
    monkeypatch.setattr(plugins, "installed_plugins", lambda group: (own,) if group is own.group else ())
    monkeypatch.setattr(plugins, "_PROBLEMS", [])
    monkeypatch.setattr(plugins, "_REPORTED", [])
    return own


def raised(error):
    try:
        raise error
    except Exception as caught:
        return caught


def test_an_error_that_nobody_expected_names_the_plug_in_it_came_through(plugin):
    told = with_plugin_named(raised(KeyError("height")))
    assert isinstance(told, PluginError)
    assert str(told) == "the plug-in 'own' of a-package 1.0 failed: KeyError: 'height'; update it, or remove it"
    assert isinstance(told.__cause__, KeyError)


def test_errors_with_a_message_for_the_user_stay(plugin):
    for error in (InputError("no such file"), OSError("full"), KeyboardInterrupt()):
        assert with_plugin_named(error) is error


def test_errors_of_this_program_stay(plugin):
    error = ValueError("of no plug-in")
    assert with_plugin_named(error) is error


def test_a_function_that_returns_something_else_is_refused_by_name(plugin):
    assert guarded(plugin, lambda: 3, int)() == 3
    with pytest.raises(PluginError, match=r"'own'.*expected a int from it, got str"):
        guarded(plugin, lambda: "3", int)()


def test_a_plug_in_that_fails_at_a_question_says_no_and_is_noted_once(plugin):
    asks = guarded_question(plugin, lambda head: head.no_such_attribute)
    assert [asks(b""), asks(b"")] == [False, False]
    (problem,) = plugin_problems()
    assert problem.plugin == plugin
    assert plugins.new_plugin_problems() == (problem,)
    assert plugins.new_plugin_problems() == ()
