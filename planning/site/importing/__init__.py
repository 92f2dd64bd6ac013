"""Sites from BIM models (IFC), city models (CityGML, CityJSON) and meshes with a stated panel grid."""
