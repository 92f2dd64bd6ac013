"""What is asked of the process of models while a camera is led about, and when it has come to rest."""

from pathlib import Path

import numpy as np

from groundstation.services.reconstruct.messages import Subject, ViewAnswer
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from tests.gui.driving import turn_until

SIZE = (640, 480)


def camera():
    return PosedPhoto("", Path(), Intrinsics(*SIZE, 500.0, 500.0, 320.0, 240.0), Pose.looking(np.zeros(3), 0.0, 0.0))


def test_pictures_are_quick_while_the_camera_moves_and_the_last_one_is_whole(application):
    from groundstation.gui.reconstruct.view_pictures import View, ViewPictures

    sent = []
    looks = ViewPictures(sent.append, lambda: SIZE)
    view = View(camera(), Subject("model", Path("m")), None, "picture")
    looks.show(view)
    for number in range(2):
        assert [look.is_quick for look in sent] == [True] * (number + 1)
        looks.show(View(camera(), view.left, None, "picture"))
        looks.take(ViewAnswer(sent[-1], np.zeros((4, 4, 3), np.uint8), seconds=1.0))
    looks.take(ViewAnswer(sent[-1], np.zeros((4, 4, 3), np.uint8), seconds=1.0))
    turn_until(application, lambda: not sent[-1].is_quick)
    assert sent[-1].camera.intrinsics.width_px == SIZE[0]
    assert [look.is_quick for look in sent] == [True] * (len(sent) - 1) + [False]
    looks.take(ViewAnswer(sent[-1], np.zeros((4, 4, 3), np.uint8), seconds=1.0))
    turn_until(application, looks.is_at_rest)
