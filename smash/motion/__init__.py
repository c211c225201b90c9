"""The arm without blocks: kinematics, collision checks, paths between configurations and their timing."""
