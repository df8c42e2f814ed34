//! How wide the strip is at each node: the mesh seen along the plane's normal.
