"""Charts drawn as SVG text: pure functions from numbers to strings, with no browser and no viser in them."""
