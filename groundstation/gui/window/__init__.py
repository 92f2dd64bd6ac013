"""The window around the tabs: menus, messages, jobs, languages, and the project as a whole."""
