"""Choosing viewpoints: greedy with a certificate, the paper's particle swarm and two baselines, one interface."""
