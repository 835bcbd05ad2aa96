"""Files: bounded reading of what others wrote, and the one way in which anything is written."""
