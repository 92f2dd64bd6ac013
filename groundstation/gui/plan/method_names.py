"""The methods of choosing views as the pilot knows them."""

from __future__ import annotations

from PySide6.QtCore import QCoreApplication


def method_name(method: str) -> str:
    """A method's name in the user's language; what is not known here stays."""
    names = {
        "greedy": QCoreApplication.translate("MethodNames", "Greedy with proof"),
        "pso": QCoreApplication.translate("MethodNames", "Particle swarm (paper)"),
        "noto": QCoreApplication.translate("MethodNames", "Nap-of-the-object grid"),
        "orbit": QCoreApplication.translate("MethodNames", "Orbits"),
    }
    return names.get(method, method)
