"""The tables and figures of both papers through the whole chain, beside the printed values, and real structures."""
