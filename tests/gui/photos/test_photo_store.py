"""Pictures of photos are decoded beside the window, few are kept, and thousands are shown without delay."""

import time
from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.photos.intake import PhotoCard, PhotoMark
from planning.photos.metadata import read_photo
from tests.gui.driving import turn_until
from tests.services.photo_cases import true_photos, write_photos


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    write_photos(folder)
    return [read_photo(path) for path in sorted(folder.iterdir())]


@pytest.fixture
def store(application):
    from groundstation.gui.photos.photo_store import PhotoStore

    store = PhotoStore()
    yield store
    store.close()


def test_small_pictures_come_later_and_no_more_are_kept_than_allowed(application, store, photos, monkeypatch):
    from groundstation.gui.photos.photo_store import THUMBNAIL_PX
    from groundstation.gui.widgets import picture_decoder

    monkeypatch.setattr(picture_decoder, "MAX_CACHED", 2)
    ready = []
    store.thumbnailReady.connect(ready.append)
    for photo in photos:
        assert store.thumbnail(photo) is None
    turn_until(application, lambda: not store.is_busy())
    assert set(ready) == {photo.path for photo in photos}
    kept = [store.thumbnail(photo) for photo in photos]
    assert sum(picture is not None for picture in kept) == 2
    assert max(picture.width() for picture in kept if picture is not None) <= THUMBNAIL_PX


def test_a_large_picture_has_the_photos_own_pixels_and_only_the_last_asked_for_comes(application, store, photos):
    from reconstruction.photos.decode import colour_picture

    came = []
    store.largeReady.connect(came.append)
    for photo in photos:
        store.ask_large(photo)
    turn_until(application, lambda: not store.is_busy())
    assert [picture.path for picture in came] == [photos[-1].path]
    image = came[0].levels[0]
    blue, green, red = colour_picture(photos[-1])[100, 200]
    assert image.pixelColor(200, 100).getRgb()[:3] == (red, green, blue)


def test_a_file_that_has_gone_is_told(application, store, photos, tmp_path):
    came = []
    store.largeReady.connect(came.append)
    store.ask_large(replace(photos[0], path=tmp_path / "gone.jpg"))
    turn_until(application, lambda: bool(came))
    assert came[0].problem == f"{tmp_path / 'gone.jpg'}: cannot be read: there is no such file"
    assert came[0].levels == ()


@pytest.mark.slow
def test_thousands_of_photos_are_shown_at_once_and_few_of_them_decoded(application, store, photos):
    from groundstation.gui.map.place_map import PlaceMap
    from groundstation.gui.photos.photo_pane import ThumbnailStrip
    from groundstation.gui.widgets.picture_decoder import MAX_WANTED

    posed = true_photos()[0]
    cards = tuple(
        PhotoCard(
            replace(photos[k % 3], path=photos[k % 3].path.with_name(f"{k}.jpg")),
            replace(
                posed, pose=replace(posed.pose, position_enu_m=posed.pose.position_enu_m + np.array([k, 0.0, 0.0]))
            ),
            (PhotoMark.BLURRED,) if k % 7 == 0 else (),
        )
        for k in range(5000)
    )
    strip, places = ThumbnailStrip(store), PlaceMap()
    started = time.thread_time()
    for widget in (strip, places):
        widget.resize(900, 160)
        widget.show()
    strip.set_cards(cards)
    places.set_photos(cards)
    strip.choose(4000)
    application.processEvents()
    assert time.thread_time() - started < 15.0
    turn_until(application, lambda: not store.is_busy())
    assert len(store._decoder._cached) <= MAX_WANTED
    assert cards[4000].path in store._decoder._cached
    strip.close()
    places.close()
