from scipy.spatial import cKDTree
def chamfer(a, b):
    return float((cKDTree(b).query(a)[0].mean()+cKDTree(a).query(b)[0].mean())/2)
