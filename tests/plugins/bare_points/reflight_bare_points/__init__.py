"""A model format: the middles of all splats, one line of text each."""

from groundstation.api import ModelExporter


def write(export):
    means = export.trained.model.splats.means.detach().numpy()
    export.out.write_text("\n".join(f"{x:.3f} {y:.3f} {z:.3f}" for x, y, z in means))
    return ["points have no colours"]


BARE_POINTS = ModelExporter((".points",), write, title="Bare points", about="The middles of splats, as text.")
