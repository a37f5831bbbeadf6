"""The style sheet of the page: a board of panels, one column in a narrow window, light and dark."""

STYLE = """
:root { --ink: #1c2024; --faint: #5a6168; --panel: #ffffff; --ground: #f2f4f6; --line: #d9dde1; --link: #0072b2;
        --warned: #8a5a00; --failed: #b3261e; --assumed: #6b4fa0; }
.body--dark { --ink: #e8eaed; --faint: #a7adb3; --panel: #1e2226; --ground: #14171a; --line: #373d43; --link: #6cbcf0;
        --warned: #f0b849; --failed: #ff8a80; --assumed: #c3a6ff; }
body { background: var(--ground); color: var(--ink); }
.nicegui-content { padding: 0; display: block; }
.top { background: var(--panel); color: var(--ink); border-bottom: 1px solid var(--line); min-height: 48px;
       padding: 4px 12px; display: flex; flex-wrap: wrap; align-items: center; gap: 4px 10px; }
.quiet { color: var(--link); background: transparent; }
.q-table__card { box-shadow: none; }
.brand { font-weight: 700; white-space: nowrap; }
.title { color: var(--faint); overflow: hidden; text-overflow: ellipsis; white-space: nowrap; max-width: 34vw; }
.spring { flex: 1 1 0; }
.status, .grid-of-case { color: var(--faint); font-size: .85rem; font-variant-numeric: tabular-nums; }
.progress { width: 110px; }
.hidden { display: none; }
.failure, .refusal { color: var(--failed); white-space: pre-wrap; overflow-wrap: anywhere; }
.failure { margin: 10px 12px 0; padding: 8px 12px; border: 1px solid var(--failed); border-radius: 6px;
           background: var(--panel); }
.drawer { background: var(--panel) !important; color: var(--ink); padding: 10px 12px !important; }
.heading { font-weight: 600; margin: 2px 0 4px; }
.table-of-case { width: 100%; border-bottom: 1px solid var(--line); }
.table-of-case .q-item { padding: 4px 0; min-height: 34px; }
.table-of-case .q-item__label--caption { color: var(--faint); }
.table-of-case .q-expansion-item__content > div, .table-of-case .nicegui-expansion-content { padding: 0 !important;
  display: block; }
.key { padding: 2px 2px 6px; width: 100%; }
.key .q-field { width: 100%; }
.key .q-field { font-size: 14px; }
.key .q-field--dense .q-field__bottom { min-height: 0; padding: 2px 0 6px; }
.key .q-field__messages { line-height: 1.25; color: var(--failed); }
.key .assumed .q-field__label { color: var(--assumed); font-style: italic; }
.key .assumed .q-field__label::after { content: " · assumed"; padding-right: 3px; }
.key .q-slider { margin: 0 6px; width: calc(100% - 12px); }
.board { display: grid; gap: 12px; padding: 12px; grid-template-columns: minmax(0, 1.15fr) minmax(330px, 1fr);
         align-items: start; }
.board > section { background: var(--panel); border: 1px solid var(--line); border-radius: 8px; padding: 10px 12px;
                   min-width: 0; }
.questions, .past { grid-column: 1 / -1; }
.bar { display: flex; justify-content: space-between; align-items: center; width: 100%; }
.chart { width: 100%; height: 380px; }
.section-chart { height: 460px; }
.film-chart { height: 300px; }
.motion-chart { height: 540px; }
.fill { width: 100%; height: 100%; }
.grid-note, .summary { color: var(--faint); font-size: .85rem; }
.coarse { color: var(--warned); font-weight: 600; }
.results { width: 100%; background: transparent; color: var(--ink); }
.results th, .results td { padding: 2px 6px !important; height: 24px !important; font-size: 13px;
                           font-variant-numeric: tabular-nums; border-color: var(--line) !important;
                           white-space: pre-wrap !important; }
.results th { color: var(--faint); }
.results.list { max-width: 560px; }
.results .figure { white-space: nowrap !important; }
.results tbody tr { cursor: default; } .history tbody tr { cursor: pointer; }
.results .warned { color: var(--warned); font-weight: 600; }
.results .failed { color: var(--failed); font-weight: 600; }
.warning { color: var(--warned); font-size: .85rem; margin-top: 6px; overflow-wrap: anywhere; }
.warning::before { content: "⚠ "; }
.arguments .q-field { width: 100%; }
.arguments { display: grid; grid-template-columns: repeat(auto-fill, minmax(210px, 1fr)); gap: 4px 14px;
             margin: 6px 0; }
.run, .axes { display: flex; align-items: center; gap: 12px; flex-wrap: wrap; margin: 6px 0; }
.axes .q-field { min-width: 220px; }
.question, .q-tab-panels { background: transparent !important; color: var(--ink); padding: 6px 0 !important; }
.answer { overflow-x: auto; }
.log { font-family: ui-monospace, monospace; font-size: 12px; max-height: 260px; overflow: auto;
       white-space: pre-wrap; }
.python { width: min(760px, 92vw); max-width: 92vw; } .python .q-textarea { width: 100%; }
.code { font-family: ui-monospace, monospace; font-size: 13px; }
:focus-visible { outline: 2px solid var(--link); outline-offset: 2px; }
@media (max-width: 1100px) { .board { grid-template-columns: minmax(0, 1fr); } .title { max-width: 50vw; } }
@media (max-width: 600px) { .board { padding: 6px; gap: 8px; } .section-chart { height: 340px; }
                            .title { max-width: 100%; }
                            .results th, .results td { padding: 2px 3px !important; font-size: 12px; } }
"""
"""Rules for the page; colours that stand on panels have a contrast of at least 4.5 to 1."""
