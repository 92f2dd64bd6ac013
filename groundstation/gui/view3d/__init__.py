"""The 3-D view: what is drawn (plain arrays), the canvas that draws it, picking, navigation and tools.

`scene_view.SceneView` is the widget. It imports VTK, which takes about a second, so it is imported when the view is
first needed. The modules that make arrays (`shapes`, `site_scene`, `plan_scene`, `hemispheres`), those that compute
with views (`pinhole`, `orbit`, `picking`, `footprint`) and the tools draw nothing and need no widget.
"""
