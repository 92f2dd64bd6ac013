"""What photo files say of themselves: camera, time, position and angles, read without decoding a picture."""
