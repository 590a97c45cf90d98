"""Pages, the animation and the window of sliders."""
