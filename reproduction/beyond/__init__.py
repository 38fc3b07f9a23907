"""The paper's finger with what its discussion leaves out, one thing after another."""
