"""Where everything stands: settings and run control in the left dock, the chart and the design in the right one."""

from __future__ import annotations

import threading
from typing import Any

import viser

from explorer.scene.camera import PRESETS
from explorer.server.bridge import Bridge, PageEvent
from explorer.server.guard import guard
from explorer.server.html_slot import Slot
from explorer.server.uploads import Uploads
from explorer.services.services import Services
from explorer.state.app_state import AppState
from explorer.state.link import Link, read_link
from explorer.state.session import LEFT_DOCK, Session
from explorer.views.chart_tabs import chart_tabs
from explorer.views.charts_view import ChartsView
from explorer.views.compare_view import CompareView
from explorer.views.design_view import DesignView
from explorer.views.help_view import HelpView
from explorer.views.help_words import purpose
from explorer.views.library_view import LibraryView
from explorer.views.on_display import Renewal, follow_best, select_first
from explorer.views.overlay_view import OverlayView
from explorer.views.parallel_view import ParallelBrushes
from explorer.views.pareto.chart import ParetoChart
from explorer.views.pareto.picking import ParetoPicking
from explorer.views.pareto.scrubber import Scrubber
from explorer.views.run_control import RunControl
from explorer.views.run_view import RunView
from explorer.views.saving import Saving
from explorer.views.scatter_view import ScatterView
from explorer.views.scene_view import SceneView
from explorer.views.screenshot_view import ScreenshotView
from explorer.views.settings_view import SettingsView
from explorer.views.ship_view import ShipView
from explorer.views.table_view import TableView
from explorer.views.toolbar_view import ToolbarView
from explorer.views.whatif_view import WhatIfView
from hpsop_core.errors import HpsopError
from hpsop_core.markup import fill

_BRAND = (25, 113, 194)


def build_shared(app: AppState, services: Services, server: viser.ViserServer) -> SettingsView:
    """The left dock: one for all browsers."""
    gui = server.gui
    gui.configure_theme(show_logo=False, show_share_button=False, brand_color=_BRAND)
    gui.set_panel_label("hpsop")
    gui.main_panel.dock_left()
    gui.main_panel.set_width(LEFT_DOCK)
    server.scene.set_up_direction("+z")

    def save(event: viser.GuiEvent[Any]) -> None:
        client = event.client
        if client is None:
            return
        try:
            case = app.drafted()
        except HpsopError as error:
            app.refuse(client.client_id, str(error))
            return
        client.send_file_download(f"{case.name}.toml", case.to_toml().encode(), save_immediately=True)

    RunView(app, services.runs, gui)
    tabs = gui.add_tab_group()
    space = tabs.add_tab("Design space")
    case_tab = tabs.add_tab("Case")
    runs = tabs.add_tab("Runs")
    for title, tab in (("Design space", space), ("Case", case_tab), ("Runs", runs)):
        with tab:
            Slot(gui, purpose(title))
    settings = SettingsView(app, services.runs, gui, space, case_tab, save)
    with runs:
        LibraryView(app, services.runs, gui)
    Slot(gui, settings.hints())
    guard(gui, app.refuse)
    return settings


def build_session(session: Session, services: Services, client: viser.ClientHandle) -> None:
    """The right dock and the 3D view of one browser."""
    gui, designs = client.gui, services.designs

    def download(name: str, data: bytes) -> None:
        client.send_file_download(name, data, save_immediately=True)

    guard(gui, session.app.refuse, files=True)
    Uploads(gui, session.app.refuse, services.ships.expect)
    with client.atomic():
        top = gui.add_panel()
        pareto = top.add_tab("Pareto front")
        top.dock_right()
        top.set_width(session.dock_width)
        bottom = gui.add_panel()
        # a browser opens the first tab: that of the ship where one is being brought in
        titles = ["Design", "Charts", "Table", "Compare", "What-if"]
        titles.insert(0 if session.app.ship.hull is not None else len(titles), "Your ship")
        tabs = {title: bottom.add_tab(title) for title in titles}
        bottom.dock_below(top)
        # what is never seen itself but must stand whatever panels are closed: a closed panel's elements are not there
        unseen = gui.add_panel()
        unseen.float(x=0, y=0, width=40, height=40)
        unseen_tab = unseen.add_tab("hpsop")
        for title, tab in tabs.items():
            with tab:
                Slot(gui, purpose(title))
        # a phone has one column, in which panels stand closed unless told otherwise
        for panel in (top, bottom, unseen):
            panel.expand()
        RunControl(session, services.runs)
        ParallelBrushes(session)
        with unseen_tab:
            Bridge(gui, session.gestures.receive)
            saving = Saving(session, gui, download)
            ToolbarView(session, services, gui, client)
            helping = HelpView(session, gui)
            you = Slot(gui)
        with pareto:
            Slot(gui, purpose("Pareto front"))
            chart = ParetoChart(session, designs, gui, saving)
            Scrubber(session, gui)
            ParetoPicking(session, designs, chart, gui)
        with tabs["Design"], session.hub.in_tab("Design"):
            DesignView(session, designs, services.refining, gui)
        with tabs["Charts"], session.hub.in_tab("Charts"):
            scatter = ScatterView(session, designs, gui).tab()
            ChartsView(session, designs, gui, chart_tabs(scatter), saving)
        with tabs["Table"], session.hub.in_tab("Table"):
            TableView(session, designs, gui, download)
        with tabs["Compare"], session.hub.in_tab("Compare"):
            CompareView(session, designs, gui)
        with tabs["What-if"], session.hub.in_tab("What-if"):
            WhatIfView(session, services, gui)
        with tabs["Your ship"]:
            ShipView(session, services.ships, services.runs, gui)
    scene = SceneView(session, designs, client)
    ScreenshotView(session, scene, client)
    OverlayView(session, designs, client)

    def hello(event: PageEvent) -> None:
        services.runs.browser_came()
        session.resize(event.numbers.get("width"), event.numbers.get("height"))
        top.set_width(session.dock_width)
        if session.narrow:
            gui.main_panel.minimize()
        session.greet(event.browser)
        you.show(fill('<style>[data-person="{}"]::after{{content:" (you)"}}</style>', session.number))
        saved = session.app.memory.get(session.browser)
        if saved is not None:
            session.restore(saved, designs.again)
        select_first(session, designs)
        session.remember()
        helping.welcome(seen=event.arg == "toured")
        theme()
        link = read_link(event.link, PRESETS)
        if link is not None:
            session.app.worker.every(lambda: follow(link))

    def follow(link: Link) -> None:
        if link.run and link.run != session.picture.name:
            try:
                services.runs.open_named(link.run)
            except HpsopError as error:
                session.notify("The link's run is not shown", str(error), "yellow")
                return
            session.app.did(session, "opened another run by a link")
        missing = session.follow_link(link, designs.linked)
        if missing:
            session.notify("Not all of the link is there", f"this run has no {', no '.join(missing)}", "yellow")

    def theme() -> None:
        gui.configure_theme(
            show_logo=False, show_share_button=False, brand_color=_BRAND, dark_mode=session.options.dark
        )

    session.gestures.on("hello", "", hello)
    session.gestures.on("stands", "", lambda event: scene.begin())
    session.gestures.on("tabs", "", lambda event: session.hub.tabs_open(event.arg.split("|")))

    def size(event: PageEvent) -> None:
        before, narrow = session.dock_width, session.narrow
        session.resize(event.numbers.get("width"), event.numbers.get("height"))
        if session.dock_width != before:
            top.set_width(session.dock_width)
        if session.narrow != narrow:
            # of this browser alone: the others' windows have their own width
            if session.narrow:
                gui.main_panel.minimize()
            else:
                gui.main_panel.expand()

    session.gestures.on("size", "", size)
    session.hub.on(("options",), theme)

    closed = threading.Event()

    def docks() -> None:
        """Open or close all panels, where that was asked for."""
        wide = session.options.wide
        if wide == closed.is_set():
            return
        (closed.set if wide else closed.clear)()
        for panel in (top, gui.main_panel):
            if wide or (session.narrow and panel is not top):
                panel.minimize()
            else:
                panel.expand()

    session.hub.on(("options",), docks)
    Renewal(session, designs)
    session.hub.on(("run", "follow", "selection"), lambda: follow_best(session, designs))
    session.worker.latest("first selection", lambda: select_first(session, designs))
