"""Plug-ins of others: tiny packages as somebody else would write them, installed and used by command."""
