"""Data of hpsop: cases, hulls, propellers, published reference figures and one finished run."""
