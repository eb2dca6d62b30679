"""Training of leaders: with PPO (`ppo`, with the extra `train`) or in pairs of branches."""
