"""All plug-ins at a glance, each tried: for the list of the command line and of the window."""

from __future__ import annotations

from dataclasses import dataclass

from planning.base.plugins import Plugin, PluginGroup, PluginProblem, installed_plugins, plugin_problems


@dataclass(frozen=True, slots=True)
class PluginRow:
    """An installed plug-in, and why it cannot be used; None where it can."""

    plugin: Plugin
    problem: PluginProblem | None


def plugin_rows() -> tuple[PluginRow, ...]:
    """All plug-ins by group and name; they are imported for it."""
    from groundstation.services.model.export import model_exporters
    from missions.formats.registry import mission_formats
    from planning.aircraft.catalogue import profiles
    from reconstruction.training.method_registry import training_methods

    for registry in (profiles, mission_formats, model_exporters, training_methods):
        registry()
    problems = {problem.plugin: problem for problem in plugin_problems()}
    return tuple(
        PluginRow(plugin, problems.get(plugin)) for group in PluginGroup for plugin in installed_plugins(group)
    )
