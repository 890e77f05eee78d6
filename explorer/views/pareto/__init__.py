"""The live Pareto chart: ``chart`` draws it, ``picking`` answers gestures on it, ``scrubber`` plays the generations."""
