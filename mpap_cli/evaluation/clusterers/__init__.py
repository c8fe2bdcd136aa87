"""The paper's five clusterers and their peers, on points whose classes are known (5.1)."""
