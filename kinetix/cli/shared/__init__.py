"""What several sub-commands have in common: options, the terminal, evaluation."""
