"""The report of finished suites: tables and plots as Markdown and SVG, the paper's numbers beside ours."""
