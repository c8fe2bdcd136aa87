"""Files of a log: bytes on disk become raw messages in time order, damaged ones too."""
