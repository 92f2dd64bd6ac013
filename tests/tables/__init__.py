"""The paper's tables, on rendered scenes with truth: `make tables` trains, scores, and writes docs/tables.md."""
