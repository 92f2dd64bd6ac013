"""The steps of a refinement in COLMAP, each in a thread of its own so that it can be cancelled.

pycolmap is an optional extra; it is imported here only, and only when it is asked for.
"""

from __future__ import annotations

import importlib
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError, ReconstructionError
from planning.base.jit import n_threads
from planning.base.messages import say
from planning.base.progress import Monitor
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.colmap.georeference import position_covariance
from reconstruction.colmap.record import camera_of

Array = NDArray[np.float64]

POLL_S = 0.2
"""Time between two looks at whether the user has cancelled."""

BATCH = 8
"""Photos whose features are found in one call, so that progress can be told in between: reading COLMAP's database while
it is written to makes COLMAP stop."""

LEAST_PHOTOS = 3


@dataclass(frozen=True, slots=True)
class RefineParameters:
    """How much work goes into a refinement.

    Parameters
    ----------
    max_image_size_px
        Photos are reduced to this for features: what costs most. docs/benchmarks.md has the poses' errors against it.
    max_features
        Of each photo.
    n_neighbours
        Photos nearest in space that each is matched with.
    exhaustive_up_to
        Sets up to this many photos are matched all with all.
    """

    max_image_size_px: int = 1600
    max_features: int = 4096
    n_neighbours: int = 20
    exhaustive_up_to: int = 40
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("max_image_size_px", "max_features", "n_neighbours"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name}: expected at least 1, got {getattr(self, name)}")


DEFAULT_PARAMETERS = RefineParameters()


@dataclass(frozen=True, slots=True, eq=False)
class ColmapRun:
    """One run: COLMAP's database in a folder of its own, and its steps in the order in which they stand here."""

    colmap: Any
    own: Path
    folder: Path
    photos: Sequence[PosedPhoto]
    parameters: RefineParameters
    monitor: Monitor

    @property
    def database(self) -> Path:
        """COLMAP's file of features and matches."""
        return self.own / "features.db"

    def find_features(self) -> set[int]:
        """Features of all photos; returns the cameras whose lens stays as it is."""
        options = self.colmap.FeatureExtractionOptions()
        options.num_threads, options.use_gpu = n_threads(), False
        options.max_image_size = self.parameters.max_image_size_px
        options.sift.max_num_features = self.parameters.max_features
        names_of: dict[Intrinsics, list[str]] = {}
        for photo in self.photos:
            names_of.setdefault(photo.intrinsics, []).append(photo.name)
        found: list[str] = []

        def n_found() -> int:
            return len(found)

        for number, (intrinsics, names) in enumerate(names_of.items(), 1):
            reader = self._reader(intrinsics)
            for start in range(0, len(names), BATCH):
                batch = names[start : start + BATCH]
                self._run(
                    say("finding features"),
                    self.colmap.extract_features,
                    self.database,
                    self.folder,
                    n_done=n_found,
                    n_all=len(self.photos),
                    image_names=batch,
                    camera_mode=self.colmap.CameraMode.SINGLE,
                    reader_options=reader,
                    extraction_options=options,
                    device=self.colmap.Device.cpu,
                )
                reader.existing_camera_id = number  # COLMAP counts cameras from 1
                found += batch
        with self.colmap.Database.open(self.database) as database:
            kept = {c.camera_id for c in database.read_all_cameras() if c.model_name == "FULL_OPENCV"}
            self._write_positions(database)
        return kept

    def _reader(self, intrinsics: Intrinsics) -> Any:
        """How COLMAP reads photos of one camera: with a lens that can bend, and the calibration it starts from."""
        reader = self.colmap.ImageReaderOptions()
        camera = camera_of(intrinsics, 0)
        numbers = camera.parameters if camera.model != "PINHOLE" else (*camera.parameters, 0.0, 0.0, 0.0, 0.0)
        reader.camera_model = "OPENCV" if camera.model == "PINHOLE" else camera.model
        reader.camera_params = ",".join(map(repr, numbers))
        return reader

    def _write_positions(self, database: Any) -> None:
        """The photos' positions in the site's frame, in place of those that COLMAP took from EXIF."""
        database.clear_pose_priors()
        position_of = {photo.name: photo.pose for photo in self.photos}
        for image in database.read_all_images():
            database.write_pose_prior(self._prior(image, position_of[image.name].position_enu_m, np.eye(3)))

    def _prior(self, image: Any, position_enu_m: Array, covariance: Array) -> Any:
        prior = self.colmap.PosePrior()
        prior.corr_data_id = image.data_id
        prior.position, prior.position_covariance = position_enu_m, covariance
        prior.coordinate_system = self.colmap.PosePriorCoordinateSystem.CARTESIAN
        return prior

    def match(self) -> None:
        """Matches between all pairs, or between neighbours where there are many."""
        options = self.colmap.FeatureMatchingOptions()
        options.num_threads, options.use_gpu = n_threads(), False
        if len(self.photos) <= self.parameters.exhaustive_up_to:
            pairs, function = self.colmap.ExhaustivePairingOptions(), self.colmap.match_exhaustive
        else:
            pairs, function = self.colmap.SpatialPairingOptions(), self.colmap.match_spatial
            pairs.max_num_neighbors, pairs.ignore_z = self.parameters.n_neighbours, False
            pairs.max_distance = 1e4  # metres: the number of neighbours is the limit
        self._run(
            say("matching photos"),
            function,
            self.database,
            matching_options=options,
            pairing_options=pairs,
            device=self.colmap.Device.cpu,
        )

    def map(self, fixed_cameras: set[int]) -> Any:
        """The largest model that the matches give, in a frame of its own."""
        options = self.colmap.IncrementalPipelineOptions()
        options.num_threads, options.random_seed = n_threads(), self.parameters.seed
        options.multiple_models, options.extract_colors = False, True
        options.min_model_size = LEAST_PHOTOS
        options.constant_cameras = fixed_cameras
        added: list[None] = []
        models = self._run(
            say("building the model"),
            self.colmap.incremental_mapping,
            self.database,
            self.folder,
            self.own,
            n_done=lambda: len(added),
            n_all=len(self.photos),
            options=options,
            next_image_callback=lambda: added.append(None),
        )
        if not models or max(model.num_reg_images() for model in models.values()) < LEAST_PHOTOS:
            raise ReconstructionError(
                say(
                    "the {} photos do not fit together: expected features that at least {} of them share; photos "
                    "must overlap by two thirds, and show more than mirroring glass",
                    len(self.photos),
                    LEAST_PHOTOS,
                )
            )
        return max(models.values(), key=lambda model: int(model.num_reg_images()))

    def adjust(self, model: Any, fixed_cameras: set[int]) -> None:
        """Bundle adjustment with the photos' positions, in place."""
        config = self.colmap.BundleAdjustmentConfig()
        photo_of = {photo.name: photo for photo in self.photos}
        priors = []
        for image_id in model.reg_image_ids():
            config.add_image(image_id)
            image = model.image(image_id)
            photo = photo_of[image.name]
            priors.append(self._prior(image, photo.pose.position_enu_m, position_covariance(photo)))
        for camera_id in fixed_cameras & set(model.cameras):
            config.set_constant_cam_intrinsics(camera_id)
        options = self.colmap.BundleAdjustmentOptions()
        options.print_summary = False
        options.ceres.solver_options.num_threads = n_threads()
        prior_options = self.colmap.PosePriorBundleAdjustmentOptions()
        prior_options.alignment_ransac.random_seed = self.parameters.seed
        prior_options.ceres.prior_position_loss_function_type = self.colmap.LossFunctionType.CAUCHY
        adjuster = self.colmap.create_pose_prior_ceres_bundle_adjuster(options, prior_options, config, priors, model)
        self._run(say("adjusting all rays"), lambda cancellation_token: adjuster.solve())

    def _run(
        self,
        stage: str,
        function: Callable[..., Any],
        *arguments: Any,
        n_done: Callable[[], int] = lambda: 0,
        n_all: int = 0,
        **options: Any,
    ) -> Any:
        """Call COLMAP in a thread of its own and pass a wish to cancel on to it; it ends after the photo at hand."""
        token = self.colmap.CancellationToken()
        result: list[Any] = []
        problem: list[Exception] = []

        def work() -> None:
            try:
                result.append(function(*arguments, **options, cancellation_token=token))
            except Exception as error:  # handed on to the caller's thread
                problem.append(error)

        thread = threading.Thread(target=work, name="colmap", daemon=True)
        thread.start()
        try:
            while thread.is_alive():
                self.monitor.report(stage, min(n_done(), n_all), n_all)
                thread.join(POLL_S)
        except BaseException:
            token.cancel()
            thread.join()
            raise
        if problem:
            raise ReconstructionError(say("COLMAP stopped while {}: {}", stage, problem[0])) from problem[0]
        return result[0]


def load_colmap() -> Any:
    """The module pycolmap.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        pycolmap: Any = importlib.import_module("pycolmap")
    except ImportError as error:
        raise InputError(
            say(
                "refining cameras needs pycolmap, which is not installed; install it with: pip install "
                "'reflight-groundstation[colmap]', or go on with the poses that the photos have"
            )
        ) from error
    pycolmap.logging.minloglevel = pycolmap.logging.Level.ERROR.value
    return pycolmap
