"""Records of a building's parts: attributes, inspections, defects, maintenance and documents, in a SQLite file.

`records.sqlite` lies beside the model. Objects are known by their IFC GlobalId alone (docs/reference/records.md).
"""
