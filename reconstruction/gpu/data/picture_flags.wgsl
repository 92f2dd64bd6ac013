// What is known of a pixel of the photo beside its colour.
const SHOWN = 1u << 24u;        // of a packed pixel of the photo: whether it is shown,
const FACADE = 1u << 25u;       // and whether it is one of a facade
