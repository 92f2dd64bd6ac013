"""Charts, whatever tab shows them."""
