"""The subject as a tree of rigid bodies: anthropometry, scaling, kinematics and dynamics."""
