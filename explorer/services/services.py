"""What views may ask for: runs, evaluations, curves, meshes. One object between the page and hpsop_core."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from explorer.charts.curves import DesignCurves
from explorer.scene.geometry import SceneGeometry, ghost_segments, scene_geometry
from explorer.scene.pressure import PressureMap, blade_map, hull_map
from explorer.server.worker import LatestWorker
from explorer.services.physics import Physics, Remembered
from explorer.state.draft import Draft
from explorer.state.library import LibraryEntry, RunLibrary
from explorer.state.run_keeper import RunKeeper
from explorer.state.run_picture import ACTIVE, FAILED, IDLE, STARTING, STOPPING, RunPicture
from explorer.state.session import AppState
from hpsop_core.case.case import Case
from hpsop_core.case.variables import DesignVariables
from hpsop_core.errors import InputError
from hpsop_core.evaluation.curves import HullLines
from hpsop_core.evaluation.fields import WaveField, blade_pressure, hull_pressure, waves
from hpsop_core.evaluation.result import Evaluation
from hpsop_core.runs.executor import default_workers

_PICTURE_SECONDS = 0.25


class Services:
    """Runs and physics for one page.

    Args:
        library: the user's runs.
        draft: the case being set up.
        workers: local processes of a run; all cores by default.
    """

    def __init__(self, library: RunLibrary, draft: Draft, workers: int | None = None) -> None:
        self._library = library
        self._draft = draft
        self._workers = workers
        self._keeper: RunKeeper | None = None
        self._guard = threading.RLock()
        self._app: AppState | None = None
        self._geometry: Remembered[SceneGeometry] = Remembered(24)
        self._waves: Remembered[WaveField] = Remembered(6)
        self._pressure: Remembered[PressureMap] = Remembered(8)
        self.physics = Physics()
        self.asked_to_delete = ""
        self._pictures = LatestWorker("pictures")
        self._refreshed = 0.0
        self._standing: tuple[object, ...] = ()

    def attach(self, app: AppState) -> None:
        """Tell this state what changes."""
        self._app = app

    # ---- designs ---------------------------------------------------------------------------------------------------
    @property
    def case(self) -> Case:
        """Of the run on display, or as set up while there is none."""
        app = self._app
        return app.picture.case if app is not None else self._draft.base

    def evaluation(self, design_id: int) -> Evaluation | None:
        """A design of the run on display."""
        keeper = self._keeper
        return keeper.evaluation(design_id) if keeper is not None else None

    def initial(self, level: int) -> Evaluation | None:
        """The initial design, from the run where it has it (ids 1 and 2), else computed."""
        keeper = self._keeper
        if keeper is not None:
            stored = keeper.evaluation(level)
            if stored is not None and stored.level == level and stored.variables == self.case.initial.variables:
                return stored
        return self.physics.initial(self.case, level)

    def evaluate(self, variables: DesignVariables, level: int) -> Evaluation:
        """A design of the user's own making."""
        return self.physics.evaluate(self.case, variables, level)

    def curves(self, evaluation: Evaluation) -> DesignCurves:
        """Resistance and thrust against Froude number."""
        return self.physics.curves(self.case, evaluation)

    def known_curves(self, evaluation: Evaluation) -> DesignCurves | None:
        """The same where it has been computed."""
        return self.physics.known_curves(self.case, evaluation)

    def lines(self, variables: DesignVariables) -> HullLines:
        """Sections and areas."""
        return self.physics.lines(self.case, variables)

    def geometry(self, variables: DesignVariables) -> SceneGeometry:
        """Meshes for the 3D view."""
        case = self.case
        key = (case.hull, case.propeller, case.initial, variables.key())
        return self._geometry.get(key, lambda: scene_geometry(case, variables))

    def ghost(self, variables: DesignVariables) -> NDArray[np.float64]:
        """A hull as a lines drawing in space: (n, 2, 3) segments of its sections and its waterline, both sides."""
        lines, geometry = self.lines(variables), self.geometry(variables)
        return ghost_segments(lines, geometry.waterline)

    def waves(self, evaluation: Evaluation, index: int) -> WaveField:
        """The water surface at a condition, by the evaluation's own level.

        Raises:
            SolverFailure: it cannot be computed.
        """
        case, condition = self.case, evaluation.conditions[index]
        key = (case, evaluation.level, evaluation.variables.key(), condition.froude_number, "waves")
        return self._waves.get(key, lambda: waves(case, evaluation, condition=index))

    def hull_pressure(self, evaluation: Evaluation, index: int) -> PressureMap:
        """Pressure on the hull at a condition, always by level 2.

        Raises:
            SolverFailure: it cannot be computed.
        """
        case, froude = self.case, evaluation.conditions[index].froude_number
        key = (case.hull, case.initial, evaluation.variables.key(), froude, "hull")

        def compute() -> PressureMap:
            return hull_map(hull_pressure(case, evaluation, condition=index), self.geometry(evaluation.variables))

        return self._pressure.get(key, compute)

    def blade_pressure(self, evaluation: Evaluation, index: int) -> PressureMap:
        """Pressure on the blades at a condition's advance coefficient, always by level 2.

        Raises:
            SolverFailure: it cannot be computed.
        """
        case, condition = self.case, evaluation.conditions[index]
        key = (case.propeller, evaluation.variables.key(), condition.advance_coefficient, "blades")

        def compute() -> PressureMap:
            return blade_map(blade_pressure(case, evaluation, condition=index), self.geometry(evaluation.variables))

        return self._pressure.get(key, compute)

    def add_by_hand(self, evaluation: Evaluation) -> int:
        """Keep a hand-made design in the run's archive.

        Raises:
            InputError: there is no run that can be written.
        """
        keeper = self._keeper
        if keeper is None:
            raise InputError("there is no run yet; press Start first")
        design_id = keeper.add_by_hand(evaluation)
        if self._app is not None:
            self._app.show_run(keeper.picture())
        return design_id

    def can_add_by_hand(self) -> bool:
        """Whether the run on display can keep a hand-made design."""
        return self._keeper is not None and self._keeper.writable

    # ---- runs ------------------------------------------------------------------------------------------------------
    def start(self) -> None:
        """Start a new run of the case as set up.

        Raises:
            InputError: the settings do not make a case, or another run is being driven.
        """
        with self._guard:
            if self._keeper is not None and self._keeper.driven:
                raise InputError("a run is under way; stop it first")
            case = self._draft.case()
            if not case.bounds.free:
                raise InputError("bounds: every variable is fixed; give at least one a range")
            path = self._library.new_path(case.name)
            keeper = RunKeeper(path, self.news, case, self._workers)
            self._show(keeper)
            keeper.start()

    def open(self, path: Path, read_only: bool = False) -> None:
        """Show a run file.

        Raises:
            InputError: no run file.
        """
        with self._guard:
            if self._keeper is not None and self._keeper.driven and self._keeper.path != path:
                raise InputError("a run is under way; stop it before you open another")
            self._show(RunKeeper(path, self.news, workers=self._workers, read_only=read_only))

    def open_named(self, name: str) -> None:
        """Show a run of the library.

        Raises:
            InputError: there is none of that name.
        """
        path = self._library.path(name)
        if path is None:
            raise InputError(f"{name[:60]}: no such run in the folder")
        self.open(path)

    def continue_named(self, name: str) -> None:
        """Show a run of the library and go on with it.

        Raises:
            InputError: there is none of that name, or it cannot be driven.
        """
        self.open_named(name)
        self.control("continue")

    def _show(self, keeper: RunKeeper) -> None:
        old, self._keeper = self._keeper, keeper
        if old is not None:
            old.close()
        if self._app is not None:
            self._app.show_run(keeper.picture())
            self._app.tell_all("library")

    def news(self) -> None:
        """Something of the run changed: make a new picture soon."""
        self._pictures.latest("picture", self._refresh)

    def _refresh(self) -> None:
        # A search tells of every evaluation; eyes need a few pictures a second.
        pause = self._refreshed + _PICTURE_SECONDS - time.monotonic()
        if pause > 0.0:
            time.sleep(pause)
        self._refreshed = time.monotonic()
        keeper, app = self._keeper, self._app
        if keeper is None or app is None:
            return
        picture = keeper.picture()
        app.show_run(picture)
        # the library says what may be deleted and continued: that changes too when the file is given back
        standing = (picture.name, picture.status, keeper.holds_file)
        if standing != self._standing:
            self._standing = standing
            app.tell_all("library")

    def draft_changed(self) -> None:
        """While no run is on display, the page shows the case as it is being set up."""
        app = self._app
        if app is None or self._keeper is not None:
            return
        try:
            case = self._draft.case()
        except InputError:
            return
        if case != app.picture.case:
            app.show_run(RunPicture("", case))

    def close_run(self) -> None:
        """Back to the set-up, with no run on display.

        Raises:
            InputError: the run is under way.
        """
        with self._guard:
            if self._keeper is not None and self._keeper.driven:
                raise InputError("a run is under way; stop it first")
            if self._keeper is not None:
                self._keeper.close()
            self._keeper = None
        if self._app is not None:
            self._app.show_run(RunPicture("", self._draft.case()))

    def control(self, what: str) -> None:
        """pause, resume, stop or continue.

        Raises:
            InputError: it cannot be done; the text says why.
        """
        keeper = self._keeper
        if keeper is None:
            raise InputError("there is no run")
        {"pause": keeper.pause, "resume": keeper.resume, "stop": keeper.stop, "continue": keeper.start}[what]()

    def extend(self, generations: int) -> None:
        """More generations.

        Raises:
            InputError: there is no run, or it cannot be written.
        """
        if self._keeper is None:
            raise InputError("there is no run")
        self._keeper.extend(generations)

    @property
    def workers(self) -> int:
        """Processes of the next run."""
        return self._workers or default_workers()

    def set_workers(self, count: object) -> None:
        """Processes of the next run.

        Raises:
            InputError: not a whole number from 1 to 64.
        """
        if isinstance(count, bool) or not isinstance(count, int | float) or not 1 <= count <= 64 or count != int(count):
            raise InputError("workers: give a whole number from 1 to 64")
        self._workers = int(count)

    def can_continue(self) -> bool:
        """Whether the run on display has generations left and can be driven."""
        keeper, app = self._keeper, self._app
        if keeper is None or app is None or not keeper.writable:
            return False
        picture = app.picture
        return picture.status not in ACTIVE and len(picture.generations) < picture.total_generations

    def can_extend(self) -> bool:
        """Whether the run on display can be asked for more generations."""
        keeper, app = self._keeper, self._app
        return (
            keeper is not None
            and app is not None
            and keeper.writable
            and app.picture.status not in (STARTING, STOPPING, FAILED, IDLE)
        )

    def part_of_generation(self) -> float:
        """How much of the generation under way is done."""
        return self._keeper.part_of_generation() if self._keeper is not None else 0.0

    def library(self) -> list[LibraryEntry]:
        """The user's runs."""
        return self._library.entries()

    def delete(self, name: str) -> None:
        """Delete a run of the library for good.

        Raises:
            InputError: it is on display, being written, or not there.
        """
        if self._keeper is not None and self._keeper.path == self._library.path(name):
            self.close_run()
        self._library.delete(name)

    def folder_text(self) -> str:
        """The folder, for people."""
        return str(self._library.folder)

    def close(self) -> None:
        """Leave no process behind."""
        self._pictures.close()
        if self._keeper is not None:
            self._keeper.close()
