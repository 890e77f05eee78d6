"""Where everything stands: settings and run control in the left dock, the chart and the design in the right one."""

from __future__ import annotations

from typing import Any

import viser

from explorer.server.bridge import Bridge, PageEvent
from explorer.server.guard import guard
from explorer.state.session import LEFT_DOCK, AppState, Session
from explorer.views.chart_tabs import chart_tabs
from explorer.views.charts_view import ChartsView
from explorer.views.compare_view import CompareView
from explorer.views.design_view import DesignView
from explorer.views.library_view import LibraryView
from explorer.views.overlay_view import OverlayView
from explorer.views.parallel_view import ParallelBrushes
from explorer.views.pareto_view import ParetoView
from explorer.views.run_control import RunControl
from explorer.views.run_view import RunView
from explorer.views.scene_view import SceneView
from explorer.views.settings_view import SettingsView
from explorer.views.toolbar_view import ToolbarView
from explorer.views.whatif_view import WhatIfView
from hpsop_core.errors import HpsopError

_BRAND = (25, 113, 194)


def build_shared(app: AppState, server: viser.ViserServer) -> SettingsView:
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
            case = app.draft.case()
        except HpsopError as error:
            app.refuse(client.client_id, str(error))
            return
        client.send_file_download(f"{case.name}.toml", case.to_toml().encode(), save_immediately=True)

    RunView(app, gui)
    tabs = gui.add_tab_group()
    space = tabs.add_tab("Design space")
    case_tab = tabs.add_tab("Case")
    runs = tabs.add_tab("Runs")
    settings = SettingsView(app, gui, space, case_tab, save)
    with runs:
        LibraryView(app, gui)
    guard(gui, app.refuse)
    return settings


def build_session(session: Session, client: viser.ClientHandle) -> None:
    """The right dock and the 3D view of one browser."""
    gui = client.gui
    guard(gui, session.app.refuse)
    with client.atomic():
        top = gui.add_panel()
        pareto = top.add_tab("Pareto front")
        top.dock_right()
        top.set_width(session.dock_width)
        bottom = gui.add_panel()
        design, charts, compare, whatif = (
            bottom.add_tab(title) for title in ("Design", "Charts", "Compare", "What-if")
        )
        bottom.dock_below(top)
        RunControl(session)
        ParallelBrushes(session)
        with pareto:
            Bridge(gui, session.receive)
            ParetoView(session, gui)
            ToolbarView(session, gui, client)
        with design:
            DesignView(session, gui)
        with charts:
            ChartsView(session, gui, chart_tabs())
        with compare:
            CompareView(session, gui)
        with whatif:
            WhatIfView(session, gui)
        with pareto:
            you = gui.add_html("")
    SceneView(session, client)
    OverlayView(session, client)

    def hello(event: PageEvent) -> None:
        _resize(session, event)
        top.set_width(session.dock_width)
        app = session.app
        session.browser = event.browser[:64]
        saved = app.memory.get(session.browser)
        app.greet(session)
        you.content = f'<style>[data-person="{session.number}"]::after{{content:" (you)"}}</style>'
        if saved is not None:
            session.restore(saved)
        if session.selected is None:
            session.select_initial()
        app.remember(session)
        theme()

    def theme() -> None:
        gui.configure_theme(
            show_logo=False, show_share_button=False, brand_color=_BRAND, dark_mode=session.options.dark
        )

    session.handle("hello", "", hello)

    def size(event: PageEvent) -> None:
        before = session.dock_width
        _resize(session, event)
        if session.dock_width != before:
            top.set_width(session.dock_width)

    session.handle("size", "", size)
    session.hub.on(("options",), theme)
    session.worker.latest("first selection", lambda: session.selected or session.select_initial())


def _resize(session: Session, event: PageEvent) -> None:
    width, height = event.numbers.get("width"), event.numbers.get("height")
    if width is not None and height is not None and 100 <= width <= 20000 and 100 <= height <= 20000:
        session.size = (int(width), int(height))
        session.hub.changed("size")
