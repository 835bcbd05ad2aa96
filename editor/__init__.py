"""The Kinetix editor and agent viewer."""
