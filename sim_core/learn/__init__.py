"""Learned cloth: fine meshes from coarse ones.

`topology` knows who is whose neighbour; `pooling` says which vertices of a fine mesh stay, `upsampling` how the others
follow from them without a network, `convolution` in which order a network reads a neighbourhood, `evaluation` how far
a frame is from its reference, `rows` what is compared.
"""
