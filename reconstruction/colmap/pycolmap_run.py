"""The steps of a reconstruction in COLMAP, each in a thread of its own so that it can be cancelled.

pycolmap is imported here only, and only when it is asked for.
"""

from __future__ import annotations

import importlib
import math
import sqlite3
import threading
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.errors import InputError, ReconstructionError
from planning.base.findings import Finding, Severity
from planning.base.jit import n_threads
from planning.base.messages import say
from planning.base.progress import Monitor
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.colmap.folder import read_model, write_model
from reconstruction.colmap.georeference import LEAST_SIGMA_M, ROBUST_SIGMAS, Similarity, position_covariance
from reconstruction.colmap.record import ColmapCamera, ColmapModel, camera_of
from reconstruction.photos.decode import mask_of_size

Array = NDArray[np.float64]

POLL_S = 0.2
"""Time between two looks at whether the user has cancelled."""

BATCH = 8
"""Photos whose features are found in one call, so that progress can be told in between: reading COLMAP's database while
it is written to makes COLMAP stop."""

PAIRS_PER_CALL = 60
"""Of a list of pairs, likewise."""

LEAST_PHOTOS = 3

LEAST_APART_RAD = math.radians(10.0)
"""Between what usual photos look at and the mean of all, from which on a focal length can be told from a distance."""

Pair = tuple[str, str]


@dataclass(frozen=True, slots=True, eq=False)
class StartPhoto:
    """A photo as COLMAP begins with it.

    Parameters
    ----------
    name
        Path below the folder of photos.
    group
        Photos of one group share a camera.
    lens
        What the camera's numbers begin with; None where only its picture is known.
    position_enu_m, covariance
        Where it was taken, shape (3,), and how well that is known, shape (3, 3); None where nothing says so.
    mask
        A picture that is black where features do not count; None where all do.
    """

    name: str
    group: Hashable
    lens: Intrinsics | None = None
    position_enu_m: Array | None = None
    covariance: Array | None = None
    mask: Path | None = None

    @classmethod
    def of(cls, photo: PosedPhoto) -> StartPhoto:
        """Of a photo with a pose."""
        place = photo.pose.position_enu_m
        return cls(photo.name, photo.intrinsics, photo.intrinsics, place, position_covariance(photo), photo.mask)


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
    least_contrast
        Of a feature (COLMAP's peak threshold): plaster and concrete have few that stand out.
    find_lens
        Whether lenses are found with the model: `FoundLens`.
    """

    max_image_size_px: int = 1600
    max_features: int = 4096
    n_neighbours: int = 20
    exhaustive_up_to: int = 40
    least_contrast: float = 0.0067
    seed: int = 0
    find_lens: EffectSetting = "auto"

    def __post_init__(self) -> None:
        for name in ("max_image_size_px", "max_features", "n_neighbours"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name}: expected at least 1, got {getattr(self, name)}")


DEFAULT_PARAMETERS = RefineParameters()


@dataclass(frozen=True, slots=True)
class Fit:
    """How well the photos of a model fit together, and with what they say of themselves.

    Parameters
    ----------
    error_px
        Median distance of image points from where the model has them, pixels of the full photos.
    miss_sigmas
        Median distance of photos from where their receivers were, in standard deviations of that; 0 for none.
    """

    error_px: float
    miss_sigmas: float


LEAST_FOR_LENS = 10
"""Photos from which on a lens is found against what they state."""

CONTRADICTED_SIGMAS = ROBUST_SIGMAS * math.sqrt(3.0)
"""Of positions: further from the model, most of them contradict it."""

MUCH_NEARER = 0.5
"""Part of their distance that positions must keep at most to speak for another lens: a lens that may bend takes up a
little of any error of receivers."""


@dataclass(frozen=True, slots=True)
class FoundLens:
    """Find calibrated lenses anew, from the photos; off, lenses without a calibration stay as they are stated, too.

    Photos rendered around a building of glass fit a found lens better than their right one by up to 1.9 %, which says
    nothing: what is found there is off by half a percent itself. With a focal length 1.5 % off it is 3.5 % in 14 photos
    of few points, 8 to 10 % in 30.
    """

    name: str = say("lens found from the photos")
    unit: str = say("% better fit")
    tolerance: float = 3.0

    def assess(self, scene: tuple[Fit, Fit] | None) -> Assessment:
        """By how the photos fit with their stated lens, and with a found one; None where none was looked for."""
        if scene is None:
            return Assessment(0.0, say("it was not looked for"), 0.0)
        stated, found = scene
        gains = [1.0 - found.error_px / stated.error_px if stated.error_px > 0.0 else 0.0]
        if stated.miss_sigmas > CONTRADICTED_SIGMAS and found.miss_sigmas < MUCH_NEARER * stated.miss_sigmas:
            gains.append(1.0 - found.miss_sigmas / stated.miss_sigmas)
        reason = say(
            "with the lens that they state, photos fit each other to {:.2f} px and their positions to {:.1f} standard "
            "deviations, with the found one to {:.2f} px and {:.1f}",
            *(stated.error_px, stated.miss_sigmas, found.error_px, found.miss_sigmas),
        )
        return Assessment(max(0.0, 100.0 * max(gains)), reason, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class ColmapRun:
    """One run: COLMAP's database in a folder of its own, and its steps in the order in which they stand here.

    A step that was interrupted goes on where it was: features and matches in the database are not found again.
    """

    colmap: Any
    own: Path
    folder: Path
    photos: Sequence[StartPhoto]
    parameters: RefineParameters
    monitor: Monitor

    @property
    def database(self) -> Path:
        """COLMAP's file of features and matches."""
        return self.own / "features.db"

    def find_features(self) -> set[int]:
        """Features of all photos; returns the cameras whose lens is calibrated, or is to stay as it is stated."""
        options = self.colmap.FeatureExtractionOptions()
        options.num_threads, options.use_gpu = n_threads(), False
        options.max_image_size = self.parameters.max_image_size_px
        options.sift.max_num_features = self.parameters.max_features
        options.sift.peak_threshold = self.parameters.least_contrast
        names_of: dict[Hashable, list[StartPhoto]] = {}
        for photo in self.photos:
            names_of.setdefault(photo.group, []).append(photo)
        known, cameras = self._features_known()
        found = [photo.name for photo in self.photos if photo.name in known]

        def n_found() -> int:
            return len(found)

        for group in names_of.values():
            reader = self._reader(group[0].lens)
            names = [photo.name for photo in group if photo.name not in known]
            shared = next((known[photo.name] for photo in group if photo.name in known), None)
            if shared is not None:
                reader.existing_camera_id = shared
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
                if shared is None:
                    shared = cameras = cameras + 1  # COLMAP counts cameras from 1
                    reader.existing_camera_id = shared
                found += batch
        with self.colmap.Database.open(self.database) as database:
            of_stated = ("OPENCV", "FULL_OPENCV") if self.parameters.find_lens == "off" else ("FULL_OPENCV",)
            kept = {c.camera_id for c in database.read_all_cameras() if c.model_name in of_stated}
            self._write_positions(database)
            is_matched = database.num_matched_image_pairs() > 0
        if not is_matched:  # matches name features by their rows
            masks = {photo.name: photo.mask for photo in self.photos if photo.mask is not None}
            keep_counted(self.database, self.parameters.max_features, masks)
        return kept

    def _features_known(self) -> tuple[dict[str, int], int]:
        """The camera of each photo whose features are in the database, by name; and how many cameras there are."""
        if not self.database.is_file():
            return {}, 0
        with self.colmap.Database.open(self.database) as database:
            images = [image for image in database.read_all_images() if database.exists_keypoints(image.image_id)]
            return {image.name: image.camera_id for image in images}, database.num_cameras()

    def _reader(self, intrinsics: Intrinsics | None) -> Any:
        """How COLMAP reads photos of one camera: with a lens that can bend, and the calibration it starts from."""
        reader = self.colmap.ImageReaderOptions()
        if intrinsics is None:
            reader.camera_model = "SIMPLE_RADIAL"
            return reader
        camera = camera_of(intrinsics, 0)
        numbers = camera.parameters if camera.model != "PINHOLE" else (*camera.parameters, 0.0, 0.0, 0.0, 0.0)
        reader.camera_model = "OPENCV" if camera.model == "PINHOLE" else camera.model
        reader.camera_params = ",".join(map(repr, numbers))
        return reader

    def _write_positions(self, database: Any) -> None:
        """The photos' positions in the site's frame, in place of those that COLMAP took from EXIF."""
        database.clear_pose_priors()
        position_of = {photo.name: photo.position_enu_m for photo in self.photos}
        for image in database.read_all_images():
            position = position_of.get(image.name)
            if position is not None:
                database.write_pose_prior(self._prior(image, position, np.eye(3)))

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
            verification_options=self._verification(),
            device=self.colmap.Device.cpu,
        )

    def _verification(self) -> Any:
        """Of matches, with random samples of our seed: else each run has other matches, and at times another model."""
        options = self.colmap.TwoViewGeometryOptions()
        options.ransac.random_seed = self.parameters.seed
        return options

    def descriptors(self) -> dict[str, NDArray[np.uint8]]:
        """Of the features of each photo, shape (n, 128), by its name."""
        with self.colmap.Database.open(self.database) as database:
            return {
                image.name: np.asarray(database.read_descriptors(image.image_id).data, np.uint8)
                for image in database.read_all_images()
                if database.exists_descriptors(image.image_id)
            }

    def match_pairs(self, pairs: Sequence[Pair]) -> None:
        """Matches between the photos of each pair, by their names."""
        options = self.colmap.FeatureMatchingOptions()
        options.num_threads, options.use_gpu = n_threads(), False
        todo = self._unmatched(pairs)
        done = len(pairs) - len(todo)
        listed = self.own / "pairs.txt"
        for start in range(0, len(todo), PAIRS_PER_CALL):
            part = todo[start : start + PAIRS_PER_CALL]
            listed.write_text("".join(f"{one} {other}\n" for one, other in part), "utf-8")
            pairing = self.colmap.ImportedPairingOptions()
            pairing.match_list_path = listed
            self._run(
                say("matching photos"),
                self.colmap.match_image_pairs,
                self.database,
                n_done=partial(int, done + start),
                n_all=len(pairs),
                matching_options=options,
                pairing_options=pairing,
                verification_options=self._verification(),
                device=self.colmap.Device.cpu,
            )

    def _unmatched(self, pairs: Iterable[Pair]) -> list[Pair]:
        with self.colmap.Database.open(self.database) as database:
            ids = {image.name: image.image_id for image in database.read_all_images()}
            return [
                (one, other)
                for one, other in pairs
                if one in ids and other in ids and not database.exists_matches(ids[one], ids[other])
            ]

    def map(self, fixed_cameras: set[int]) -> Any | None:
        """The largest model that the matches give, in a frame of its own; None where they give none."""
        options = self.colmap.IncrementalPipelineOptions()
        # With several threads the same matches give another model each time.
        options.num_threads, options.random_seed = 1, self.parameters.seed
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
            return None
        return max(models.values(), key=lambda model: int(model.num_reg_images()))

    def cameras(self) -> dict[int, ColmapCamera]:
        """As the database has them, by their numbers."""
        with self.colmap.Database.open(self.database) as database:
            return {
                camera.camera_id: ColmapCamera(
                    camera.camera_id, camera.model_name, camera.width, camera.height, tuple(map(float, camera.params))
                )
                for camera in database.read_all_cameras()
            }

    def identities(self) -> dict[str, tuple[int, int]]:
        """Numbers of each photo and of its camera in the database, by its name."""
        with self.colmap.Database.open(self.database) as database:
            return {image.name: (image.image_id, image.camera_id) for image in database.read_all_images()}

    def triangulate(self, model: ColmapModel, folder: Path, most_error_px: float) -> Any:
        """A model of the same poses with the points that the matches give.

        Parameters
        ----------
        model
            With the images' and cameras' numbers of the database; its points are left out.
        folder
            New folder for files in between.
        most_error_px
            Points that are further off are left out.
        """
        poses, found = folder / "poses", folder / "points"
        poses.mkdir(parents=True)
        found.mkdir()
        empty = np.zeros((0, 2)), np.zeros(0, np.int64)
        bare = {
            number: replace(image, points_px=empty[0], point_ids=empty[1]) for number, image in model.images.items()
        }
        write_model(poses, ColmapModel(model.cameras, bare))
        options = self.colmap.IncrementalPipelineOptions()
        options.num_threads, options.random_seed = 1, self.parameters.seed
        options.mapper.filter_max_reproj_error = most_error_px
        start = self.colmap.Reconstruction(poses)

        def work(cancellation_token: Any) -> Any:
            del cancellation_token  # this step takes none; it is short
            reconstruction = self.colmap.triangulate_points(
                start, self.database, self.folder, found, clear_points=True, options=options
            )
            reconstruction.extract_colors_for_all_images(self.folder)
            return reconstruction

        return self._run(say("placing photos by their receivers"), work)

    def with_found_lenses(self, model: Any, cameras: set[int], folder: Path) -> Any:
        """A copy of a model, adjusted with the photos' positions, whose stated lenses are where that begins only.

        Centres and distortion are found anew, and focal lengths where photos look in several directions: looking down
        from one height, a longer one and a lower ground show the same. The denominators of the rational distortion are
        left out, which positions say nothing of.

        Parameters
        ----------
        folder
            New folder for files in between.
        """
        folder.mkdir(parents=True)
        model.write_binary(folder)
        found = self.colmap.Reconstruction(folder)
        for number in cameras & set(found.cameras):
            camera = found.camera(number)
            fx, fy, *others = list(camera.params)[:8]  # then cx, cy, k1, k2, p1, p2 in both models
            camera.model = self.colmap.CameraModelId.OPENCV
            camera.params = [0.5 * (fx + fy), 0.5 * (fx + fy), *others]
        forwards = np.array([found.image(one).cam_from_world().rotation.matrix()[2] for one in found.reg_image_ids()])
        self.adjust(found, set(), finds_centres=True, finds_focal_lengths=not look_one_way(forwards))
        return found

    def choose_lenses(self, model: Any, cameras: set[int], folder: Path) -> tuple[Any, Decision]:
        """The model with lenses as they are stated, or as they are found from the photos, and why.

        Parameters
        ----------
        model
            In the frame of the photos' positions, adjusted with them.
        cameras
            Those of which lenses are stated.
        folder
            New folder for files in between.
        """
        setting = self.parameters.find_lens
        least = LEAST_FOR_LENS if setting == "auto" else LEAST_PHOTOS
        if setting == "off" or model.num_reg_images() < least:
            return model, decide(FoundLens(), None, setting)
        found = self.with_found_lenses(model, cameras, folder)
        decision = decide(FoundLens(), (self.fit_of(model), self.fit_of(found)), setting)
        return (found if decision.on else model), decision

    def fit_of(self, model: Any) -> Fit:
        """Of a model in the frame of the photos' positions."""
        model.update_point_3d_errors()
        points = list(model.points3D.values())
        errors = np.repeat([point.error for point in points], [point.track.length() for point in points])
        photo_of = {photo.name: photo for photo in self.photos}
        misses = []
        for image in (model.image(number) for number in model.reg_image_ids()):
            photo = photo_of[image.name]
            if photo.position_enu_m is not None and photo.covariance is not None:
                sigma_m = max(LEAST_SIGMA_M, math.sqrt(float(np.trace(photo.covariance)) / 3.0))
                misses.append(float(np.linalg.norm(image.projection_center() - photo.position_enu_m)) / sigma_m)
        return Fit(float(np.median(errors)) if len(errors) else 0.0, float(np.median(misses)) if misses else 0.0)

    def adjust(
        self, model: Any, fixed_cameras: set[int], finds_centres: bool = False, finds_focal_lengths: bool = True
    ) -> None:
        """Bundle adjustment with the photos' positions, in place.

        Parameters
        ----------
        finds_centres
            Whether principal points are adjusted, too: positions to centimetres say where these are.
        finds_focal_lengths
            Whether focal lengths are.
        """
        config = self.colmap.BundleAdjustmentConfig()
        photo_of = {photo.name: photo for photo in self.photos}
        priors = []
        for image_id in model.reg_image_ids():
            config.add_image(image_id)
            image = model.image(image_id)
            photo = photo_of[image.name]
            if photo.position_enu_m is not None and photo.covariance is not None:
                priors.append(self._prior(image, photo.position_enu_m, photo.covariance))
        for camera_id in fixed_cameras & set(model.cameras):
            config.set_constant_cam_intrinsics(camera_id)
        options = self.colmap.BundleAdjustmentOptions()
        options.print_summary = False
        options.refine_principal_point, options.refine_focal_length = finds_centres, finds_focal_lengths
        options.ceres.solver_options.num_threads = n_threads()
        prior_options = self.colmap.PosePriorBundleAdjustmentOptions()
        prior_options.alignment_ransac.random_seed = self.parameters.seed
        # Points that glass mirrors fit each other in few photos, and pull these away.
        options.ceres.loss_function_type = self.colmap.LossFunctionType.CAUCHY
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


def about_lens(decision: Decision) -> Finding:
    """That a lens was found, or stayed as it is stated, and why."""
    return Finding(Severity.NOTE, "lens-chosen", str(decision), "", decision.size, decision.tolerance, decision.unit)


def look_one_way(forwards: Array) -> bool:
    """Whether most cameras look the same way, by where they look, shape (n, 3)."""
    mean = forwards.mean(axis=0)
    cosines = forwards @ mean / max(float(np.linalg.norm(mean)), 1e-9)
    return float(np.median(np.arccos(np.clip(cosines, -1.0, 1.0)))) <= LEAST_APART_RAD


def keep_counted(path: Path, n_most: int, masks: Mapping[str, Path] | None = None) -> None:
    """Take features out of a database that has no matches yet: what a photo's mask has black, and all but the largest.

    COLMAP takes its limit for whole levels of scale: of grass and gravel it finds up to twice as many, which take four
    times as long to match.

    Parameters
    ----------
    masks
        By photos' names.
    """
    masks = {} if masks is None else masks
    with closing(sqlite3.connect(path)) as database, database:
        photos = database.execute(
            "SELECT image_id, name, width, height, rows FROM images JOIN cameras USING (camera_id) "
            "JOIN keypoints USING (image_id)"
        )
        for image, name, width, height, n_rows in photos.fetchall():
            mask = masks.get(name)
            if n_rows == 0 or (n_rows <= n_most and mask is None):
                continue
            columns, data = database.execute("SELECT cols, data FROM keypoints WHERE image_id = ?", (image,)).fetchone()
            numbers = np.frombuffer(data, np.float32).reshape(n_rows, columns)
            # x, y and either the scale or a matrix, whose first column is as long as the scale.
            scales = numbers[:, 2] if columns == 4 else np.hypot(numbers[:, 2], numbers[:, 4])
            counted = np.arange(n_rows)
            if mask is not None:
                x, y = (numbers[:, axis].astype(int).clip(0, most - 1) for axis, most in enumerate((width, height)))
                counted = np.flatnonzero(mask_of_size(mask, width, height)[y, x])
            chosen = np.sort(counted[np.argsort(-scales[counted], kind="stable")[:n_most]])
            for table in ("keypoints", "descriptors"):
                (content,) = database.execute(f"SELECT data FROM {table} WHERE image_id = ?", (image,)).fetchone()
                rows = np.frombuffer(content, np.uint8).reshape(n_rows, -1)[chosen]
                database.execute(
                    f"UPDATE {table} SET rows = ?, data = ? WHERE image_id = ?", (len(rows), rows.tobytes(), image)
                )


def do_not_fit(n_photos: int) -> ReconstructionError:
    """Of photos that give no model."""
    return ReconstructionError(
        say(
            "the {} photos do not fit together: expected features that at least {} of them share; photos "
            "must overlap by two thirds, and show more than mirroring glass",
            n_photos,
            LEAST_PHOTOS,
        )
    )


def as_model(reconstruction: Any, folder: Path) -> ColmapModel:
    """A reconstruction as our record, by way of files in a new folder."""
    folder.mkdir()
    reconstruction.write_binary(folder)
    return read_model(folder)


def transform(colmap: Any, reconstruction: Any, similarity: Similarity) -> None:
    """Bring a reconstruction into another frame, in place."""
    turned = colmap.Sim3d(similarity.scale, colmap.Rotation3d(similarity.rotation), similarity.translation)
    reconstruction.transform(turned)


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
                "matching photos needs pycolmap, which is not installed; install it with: pip install "
                "'reflight-groundstation[colmap]'"
            )
        ) from error
    pycolmap.logging.minloglevel = pycolmap.logging.Level.FATAL.value  # what fails is raised, and told once
    return pycolmap
