"""What an episode looked like: recordings, pictures, films, replays, trajectories."""
