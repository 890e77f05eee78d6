"""The open-water test that every one of ours is like unless told otherwise: DTMB P4119's (Jessup 1989)."""

MODEL_DIAMETER = 0.3048  # m
MODEL_ROTATION_RATE = 10.0  # 1/s
MODEL_VISCOSITY = 1e-6  # kinematic, m2/s
