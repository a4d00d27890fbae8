from scipy.spatial import cKDTree
def fscore(a, b, t):
    r=(cKDTree(b).query(a)[0]<=t).mean(); p=(cKDTree(a).query(b)[0]<=t).mean()
    return float(2*p*r/(p+r)) if p+r else 0.0
