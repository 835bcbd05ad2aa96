"""Dear ImGui as the app uses it: widgets, theme, fonts, icons."""
