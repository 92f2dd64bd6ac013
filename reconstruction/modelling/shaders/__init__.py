"""The shading of methods that know no panels, each in a module."""
