"""The networks, one file each; `build.build_network` makes one from a `config.NetworkConfig`."""
