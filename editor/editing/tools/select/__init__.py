"""The select tool: one file for each gesture."""
