"""Parts that several sub-commands share: options, the terminal, evaluation."""
