"""`kinetix-editor --bench`: the table of performance targets, measured on this machine."""

from editor.hosts.bench.table import print_table

__all__ = ["print_table"]
