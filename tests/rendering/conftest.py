"""Windows open on SDL's dummy screen: conformance suites try every render mode."""

import os

os.environ["SDL_VIDEODRIVER"] = "dummy"
