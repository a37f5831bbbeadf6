"""The studio: a local web page on which a bearing is changed and answers.

What is asked and computed, without widgets:

- ``design``        tables of a case as they were typed
- ``form``          the fields of a case, read from its definitions
- ``page_session``       one tab: its design, its answers, what was tried
- ``state``         what of a session is shown
- ``live``          answers that follow a design while it changes
- ``protocol``      what server and workers say to each other
- ``worker_pool``        the workers and their queue
- ``worker_process`` the server's end of a worker
- ``worker``        the process that computes
- ``lifeline``      ends it with the server
- ``freed_memory``  gives the system back what a task has freed
- ``tasks``         what it computes: an answer, a file
- ``study_tasks``   studies: a map, a search
- ``arrays``        what of an answer the browser draws
- ``one_page``      an answer as a report

The page:

- ``address``       where the server is, and the start of a studio
- ``server``        sessions, the application, its end
- ``guard``         who may speak to the server, and how much
- ``page``          the whole page
- ``case_panel``    the case: fields and sliders
- ``results_panel`` results beside those of the pinned design
- ``questions``     the analyses as tabs
- ``study_panel``   what panels of a study share
- ``map_panel``     a result over one or two parameters
- ``optimum_panel`` the best design, and the front of two objectives
- ``parameter_choice`` a parameter of the case and its values, for both
- ``downloads``     what leaves the page as a file
- ``charts``        charts of film, series, maps, and the 3-D view
- ``section_chart`` the cross-section
- ``motion_chart``  a motion: its section played, path and histories
- ``themes``        colours of charts
- ``look``          style sheet

Conventions: nothing but `petalfoil studio` imports this folder. What comes from a browser is text or a number until
a `Case` or an argument has read it; no path from a browser reaches the file system, and no text of a case is put into a
page as HTML.
"""
