"""What is said of data sets, trainings and models: stages, effects and errors, most of them by another process."""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

SENTENCES = (
    QT_TRANSLATE_NOOP("Sentences", "reading the data set"),
    QT_TRANSLATE_NOOP("Sentences", "there are no photos with a pose to prepare"),
    QT_TRANSLATE_NOOP("Sentences", "preparing photos"),
    QT_TRANSLATE_NOOP("Sentences", "none of the {0} photos can be read; the first: {1}"),
    QT_TRANSLATE_NOOP("Sentences", "writing cameras and points"),
    QT_TRANSLATE_NOOP("Sentences", "the picture cannot be decoded; it was left out"),
    QT_TRANSLATE_NOOP("Sentences", "the picture has {0} pixels, its camera {1} x {2}; it was left out"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be coded as {0}"),
    QT_TRANSLATE_NOOP("Sentences", "is not empty; name a new folder for the data set"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be made ({0})"),
    QT_TRANSLATE_NOOP("Sentences", "refining the mesh"),
    QT_TRANSLATE_NOOP("Sentences", "placing splats"),
    QT_TRANSLATE_NOOP("Sentences", "colouring splats"),
    QT_TRANSLATE_NOOP("Sentences", "counting glass"),
    QT_TRANSLATE_NOOP("Sentences", "reading rays"),
    QT_TRANSLATE_NOOP("Sentences", "choosing a model of mirrored light"),
    QT_TRANSLATE_NOOP("Sentences", "learning reflections"),
    QT_TRANSLATE_NOOP("Sentences", "training"),
    QT_TRANSLATE_NOOP("Sentences", "paused"),
    QT_TRANSLATE_NOOP("Sentences", "settling"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "splats and the light that panels mirror, by the model that the scene calls for: near things are a "
        "scene that mirrored rays march through",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "splats with reflectivity and base reflectance, and a network that gives mirrored light by place and direction",
    ),
    QT_TRANSLATE_NOOP("Sentences", "one of its parts left out"),
    QT_TRANSLATE_NOOP("Sentences", "flat discs whose colour depends on the direction by spherical harmonics"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "discs with albedo, metallic and roughness, shaded after blending by an environment cube (split sum),"
        " with light from other surfaces where the mirrored ray meets the known mesh",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "discs with diffuse colour, roughness and features, shaded after blending by a small network from "
        "features of the mirrored direction times those of the place",
    ),
    QT_TRANSLATE_NOOP("Sentences", "ellipsoids whose colour depends on the direction by spherical harmonics"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "ellipsoids, each shaded for itself: diffuse colour, tint times an environment cube by its shortest "
        "axis and roughness, and harmonics for the rest",
    ),
    QT_TRANSLATE_NOOP("Sentences", "small photos or a first look"),
    QT_TRANSLATE_NOOP("Sentences", "for photos of some hundred pixels' width, or windows of larger ones"),
    QT_TRANSLATE_NOOP("Sentences", "the paper's network and number of steps, as far as they go"),
    QT_TRANSLATE_NOOP("Sentences", "cannot be made ({0}); name another folder"),
    QT_TRANSLATE_NOOP("Sentences", "holds no finished model"),
    QT_TRANSLATE_NOOP("Sentences", "has no dataset.json; name a folder that `prepare` or `scene render` has finished"),
    QT_TRANSLATE_NOOP("Sentences", "lists no panels, so there is no glass to learn from"),
    QT_TRANSLATE_NOOP("Sentences", "panels: expected indices 1, 2, 3 and so on; was the file edited?"),
    QT_TRANSLATE_NOOP("Sentences", "panel {0} has next to no area; correct the site and prepare again"),
    QT_TRANSLATE_NOOP("Sentences", "holds no images; name a folder with photos"),
    QT_TRANSLATE_NOOP("Sentences", "expected at least two photos, one to learn from and one to score, got {0}"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0} x {1} pixels as its camera has, got {2} x {3}"),
    QT_TRANSLATE_NOOP("Sentences", "expected one channel with panel numbers, found {0}"),
    QT_TRANSLATE_NOOP("Sentences", "has panel {0}, and dataset.json {1}; is it of another run?"),
    QT_TRANSLATE_NOOP("Sentences", "photos of {0} x {1} pixels cannot be made {2} times smaller; choose less"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0} channel(s) of {1} bit; make the folder again"),
    QT_TRANSLATE_NOOP("Sentences", "expected {0} x {1} pixels by its camera, got {2} x {3}; make the folder again"),
    QT_TRANSLATE_NOOP("Sentences", "has none of the photos to be used; name a folder that has them"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its photos take {0} MiB each while they are read, more than the limit of {1} MiB; allow more memory,"
        " or take smaller photos",
    ),
    QT_TRANSLATE_NOOP("Sentences", "expected an image of 8 or 16 bit, found {0}"),
    QT_TRANSLATE_NOOP("Sentences", "the file is empty; copy it again"),
    QT_TRANSLATE_NOOP("Sentences", "is no checkpoint, or damaged ({0}); begin the training anew"),
    QT_TRANSLATE_NOOP("Sentences", "is no checkpoint; begin the training anew"),
    QT_TRANSLATE_NOOP("Sentences", "holds no state of a training; begin the training anew"),
    QT_TRANSLATE_NOOP("Sentences", "resume its training"),
    QT_TRANSLATE_NOOP("Sentences", "name one of `train`"),
    QT_TRANSLATE_NOOP("Sentences", "holds no finished model; {0}"),
    QT_TRANSLATE_NOOP("Sentences", "weights.file: expected the name of a file beside it, got '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "is not the file that {0} was written with; was it changed or cut off?"),
    QT_TRANSLATE_NOOP("Sentences", "is no safetensors file, or damaged: {0}"),
    QT_TRANSLATE_NOOP("Sentences", "holds numbers that are not finite; train again"),
    QT_TRANSLATE_NOOP("Sentences", "has splats on panel {0} of {1}"),
    QT_TRANSLATE_NOOP("Sentences", "holds the weights of another model than {0} describes ({1})"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "none of {0} photos has a pixel that lies whole on a panel; take larger photos or come closer, or "
        "train splats alone (--method 2dgs)",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "none of {0} photos has a pixel that lies whole on a panel; take larger photos or come closer",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "its photos, cameras or panels are not those that the training was begun with; name that data set",
    ),
    QT_TRANSLATE_NOOP("Sentences", "is of another version, or damaged ({0}); begin the training anew"),
    QT_TRANSLATE_NOOP("Sentences", "shows other panels; name the data set that the training was begun with"),
    QT_TRANSLATE_NOOP("Sentences", "lacks the photo '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "shows other panels"),
    QT_TRANSLATE_NOOP("Sentences", "{0}; name the data set that the training was begun with"),
    QT_TRANSLATE_NOOP("Sentences", "is damaged ({0}); begin the training anew"),
    QT_TRANSLATE_NOOP("Sentences", "is of a training of {0}; resume with that method"),
    QT_TRANSLATE_NOOP("Sentences", "device: 'cuda' is asked for, and torch finds no CUDA device; leave it out"),
    QT_TRANSLATE_NOOP("Sentences", "holds no training that was interrupted; begin the training anew"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "holds a training that was interrupted; resume it, name another folder, or delete {0}",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "training failed at step {0}: {1}, and lower rates do not help{2}; train again with lower rates or "
        "fewer splats",
    ),
    QT_TRANSLATE_NOOP("Sentences", "step {0} was undone ({1}); all rates are halved from there on"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "training failed at step {0}: there is no memory for {1} splats and windows of {2} pixels{3}; train "
        "with fewer splats",
    ),
    QT_TRANSLATE_NOOP("Sentences", "memory ran out at step {0}: windows of photos have {1} pixels from there on"),
    QT_TRANSLATE_NOOP("Sentences", "memory ran out while splats were added"),
    QT_TRANSLATE_NOOP("Sentences", "; the last checkpoint, {0}, is good"),
    QT_TRANSLATE_NOOP("Sentences", "training failed at step {0}: {1}; train again"),
    QT_TRANSLATE_NOOP("Sentences", "went back to step {0}"),
    QT_TRANSLATE_NOOP("Sentences", "is of another model or version ({0}); begin the training anew"),
    QT_TRANSLATE_NOOP("Sentences", "the loss is not a number"),
    QT_TRANSLATE_NOOP("Sentences", "a gradient is not a number"),
    QT_TRANSLATE_NOOP("Sentences", "a weight is not a number"),
    QT_TRANSLATE_NOOP("Sentences", "learning reflections failed: {0} at step {1} of {2}; lower the learning rates"),
    QT_TRANSLATE_NOOP("Sentences", "learning light: {0} at step {1}; all rates are halved from there on"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "learning reflections failed: there is no memory for batches of {0} rays at step {1} of {2}; choose a"
        " smaller model",
    ),
    QT_TRANSLATE_NOOP("Sentences", "learning light: memory ran out at step {0}; batches have {1} rays from there"),
    QT_TRANSLATE_NOOP("Sentences", "torch finds no CUDA device"),
    QT_TRANSLATE_NOOP("Sentences", "gsplat is not installed (pip install 'reflight[cuda]')"),
    QT_TRANSLATE_NOOP("Sentences", "gsplat's kernels are not compiled, which takes NVIDIA's CUDA toolkit"),
    QT_TRANSLATE_NOOP("Sentences", "splats on CUDA are drawn by gsplat, and {0}; or compute on the processor"),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "there are no photos, so nobody knows how finely splats are seen; name a folder with photos",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "no panel, mesh or point within {0} m of the model's middle is seen by one of the {1} photos; are the"
        " poses and the points in one frame?",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "of {0} points of photogrammetry none is away from glass, so splats cannot start from points; put some there"
        " ({1}, or a COLMAP model in {2}), or start from surfaces",
    ),
    QT_TRANSLATE_NOOP(
        "Sentences",
        "there are no panels, no mesh and no points to start from; prepare the data set again",
    ),
    QT_TRANSLATE_NOOP("Sentences", "its points have no '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "has points whose coordinates are not finite numbers; make it again"),
    QT_TRANSLATE_NOOP("Sentences", "there is no model yet: it is being prepared"),
    QT_TRANSLATE_NOOP("Sentences", "the picture could not be rendered ({0}); make the window smaller"),
    QT_TRANSLATE_NOOP("Sentences", "has no photo '{0}'"),
    QT_TRANSLATE_NOOP("Sentences", "near-field light"),
    QT_TRANSLATE_NOOP("Sentences", "show parallax"),
    QT_TRANSLATE_NOOP("Sentences", "show no parallax to speak of"),
    QT_TRANSLATE_NOOP("Sentences", "mirror images in unseen photos {0}: radiance grid {1} dB, environment map {2} dB"),
    QT_TRANSLATE_NOOP("Sentences", "mirrored surroundings"),
    QT_TRANSLATE_NOOP("Sentences", "clear mirror images"),
    QT_TRANSLATE_NOOP("Sentences", "no clear mirror images"),
    QT_TRANSLATE_NOOP("Sentences", "the panes show {0}: harmonics alone {1} dB"),
)
