"""Photos as a training looks at them: decoded, streamed, their exposures, poses and errors."""
