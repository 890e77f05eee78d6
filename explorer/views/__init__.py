"""The page's views: each draws from the state and none knows another."""
