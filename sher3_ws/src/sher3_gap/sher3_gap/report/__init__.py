"""The HTML report of a diagnosis: one self-contained page, one section per file."""

from sher3_gap.report.page import write_report as write_report
